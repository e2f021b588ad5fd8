"""A world that is changed while it runs, by the command line and by Python, through the real programs."""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

from programs import BIN, DEADLINE_S, Daemon, visum as run_visum

sys.path.insert(0, str(BIN.parent / "python"))
import visum  # noqa: E402

BALL = "{name: ball, mass: 0.5, pose: {xyz: [1.5, 0, 2]}, shapes: [{sphere: 0.1}]}"
DOOR = "{name: door, kinematic: true, pose: {xyz: [3, 0, 2]}, shapes: [{box: [0.1, 1, 1]}]}"

WEDGE = "".join(("solid wedge\n", *(
    "facet normal 0 0 0\nouter loop\n" + "".join(f"vertex {x} {y} {z}\n" for x, y, z in corners) + "endloop\nendfacet\n"
    for corners in (((0, 0, 0), (0, 1, 0), (1, 0, 0)), ((0, 0, 0), (1, 0, 0), (0, 0, 1)),
                    ((0, 0, 0), (0, 0, 1), (0, 1, 0)), ((1, 0, 0), (0, 1, 0), (0, 0, 1)))), "endsolid wedge\n"))
ROBOT = """<robot name="arm">
  <link name="base"><visual><geometry><mesh filename="meshes/wedge.stl"/></geometry></visual></link>
  <link name="stick">
    <inertial><mass value="1"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><sphere radius="0.05"/></geometry></collision>
  </link>
  <joint name="turn" type="revolute">
    <parent link="base"/><child link="stick"/><origin xyz="0 0 1"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" velocity="1" effort="10"/>
  </joint>
</robot>
"""


class ChangingWorld(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = folder.name
        self.daemon = Daemon("--clock", "lockstep", "--files", self.folder)
        self.daemon.__enter__()
        self.addCleanup(self.daemon.__exit__)
        self.client = visum.Client(self.daemon.connect, role="admin", name="test")
        self.addCleanup(self.client.close)
        self.client.add_body(BALL)
        self.client.add_body(DOOR)
        self.client.join()

    def body(self, name):
        return self.client.read_world().body(name)

    def test_bodies_and_joints_are_put_elsewhere(self):
        self.daemon.visum("pose", "ball", "0.5,-0.25,3")
        self.assertEqual(self.body("ball").position, (0.5, -0.25, 3.0))
        self.daemon.visum("pose", "ball", "-1,0,3,0,0,1.5707963267948966", "--velocity", "0,0,1")
        self.assertAlmostEqual(self.body("ball").quaternion[3], 0.5 ** 0.5, 12)
        self.assertEqual(self.body("ball").velocity, (0.0, 0.0, 1.0))
        self.client.set_body("ball", (2, 0, 2), velocity=(0, 1, 0))
        self.assertAlmostEqual(self.body("ball").quaternion[3], 0.5 ** 0.5, 12, "it keeps its direction")
        self.daemon.visum("joints", "arm", "joint_1=0.5", "joint_4=-0.25")
        self.assertAlmostEqual(self.client.read_world().joint("arm/joint_4").position, -0.25, 12)
        self.client.set_joints("arm", {"joint_1": -0.5})
        self.assertAlmostEqual(self.client.read_world().joint("arm/joint_1").position, -0.5, 12)
        refused = self.daemon.visum("joints", "arm", "joint_1=99", expect=2)
        self.assertIn("joint 'arm/joint_1' goes from", refused.stderr)
        self.assertIn("X,Y,Z", self.daemon.visum("pose", "ball", "1,2", expect=2).stderr)
        self.assertIn("did you mean 'ball'", self.daemon.visum("pose", "bal", "1,2,3", expect=2).stderr)

    def test_pulls_end_with_their_program(self):
        pull = subprocess.Popen([BIN / "visum", "pull", "ball", "0,0,0", "--to", "1.5,0,2.5", "--max-force", "50",
                                 "--seconds", "0.5", "--connect", self.daemon.connect])
        while self.body("ball").position[2] < 2.3:  # until it pulls
            self.client.advance_ms(10)
        for _ in range(200):
            self.client.advance_ms(10)
            if pull.poll() is not None:
                break
        self.assertEqual(pull.wait(DEADLINE_S), 0)
        self.client.pull_body("ball", (1.5, 0, 2.5), 50)
        self.client.advance_ms(600)
        self.assertAlmostEqual(self.body("ball").position[2], 2.5 - 9.81 / 400, 2)
        self.client.release_body("ball")
        with self.assertRaises(visum.Error) as refused:
            self.client.release_body("ball")
        self.assertEqual(refused.exception.code, visum.ErrorCode.WRONG_STATE)

    def test_a_kinematic_door_moves_on_after_the_command(self):
        self.daemon.visum("pose", "door", "3,0,2", "--velocity", "0,0,0.5,0,0,1")
        self.client.advance_ms(1000)
        self.assertAlmostEqual(self.body("door").position[2], 2.5, 9)
        self.assertAlmostEqual(self.body("door").angular_velocity[2], 1.0, 12)

    def test_resets_have_scopes(self):
        self.client.advance_ms(100)
        era = self.client.status().era
        self.daemon.visum("reset", "--scope", "state")
        self.assertEqual((self.client.status().tick, self.client.status().era), (100, era + 1))
        self.daemon.visum("reset", "--scope", "time")
        self.assertEqual(self.client.status().tick, 0)
        self.client.reset("spawned")
        self.assertNotIn("ball", self.client.world().body_names)
        self.client.add_body(BALL)
        self.daemon.visum("reset", "--scope", "all")
        self.assertNotIn("ball", self.client.world().body_names)
        self.assertIn("did you mean 'time'", self.daemon.visum("reset", "--scope", "tim", expect=2).stderr)

    def test_events_are_listed_and_followed(self):
        with visum.Client(self.daemon.connect, name="gripper") as controller:
            arm = controller.part("arm")
            arm.acquire()
            controller.announce("the box is gripped", kind="check")
            arm.release()
        self.client.pause()
        self.client.resume()
        lines = self.daemon.visum("events", "--json").stdout.splitlines()
        events = [json.loads(line) for line in lines]
        for event in events:
            self.assertEqual(list(event), ["tick", "sim_time_ns", "era", "level", "kind", "source", "text"])
        told = [(event["kind"], event["source"]) for event in events]
        for one in (("lease_granted", "gripper"), ("check", "gripper"), ("lease_released", "gripper"), ("pause", "test")):
            self.assertIn(one, told)
        follower = subprocess.Popen([BIN / "visum", "events", "--follow", "--json", "--connect", self.daemon.connect],
                                    stdout=subprocess.PIPE, text=True)
        self.addCleanup(follower.stdout.close)
        self.assertEqual(self.client.subscribe_events("warning"), [])
        self.client.connection.request(inject_fault=visum.connection.pb.InjectFault(part="arm", kind="part_silent"))
        kinds = []
        while "fault" not in kinds:
            kinds.append(json.loads(follower.stdout.readline())["kind"])
        self.client.reset()
        while "era" not in kinds:
            kinds.append(json.loads(follower.stdout.readline())["kind"])
        self.assertIn("fault", [event.kind for event in self.client.events()])
        follower.terminate()
        follower.wait(DEADLINE_S)

    def test_models_come_and_go_with_their_parts(self):
        self.assertIn("cart/cart.yaml", self.client.models())
        self.assertIn("cart/cart.yaml\n", self.daemon.visum("spawn", "--list").stdout)
        spawned = self.daemon.json("spawn", "cart/cart.yaml", "--name", "second", "--pose", "0,4,0")
        self.assertEqual((spawned["name"], spawned["parts"]), ("second", ["second"]))
        self.assertAlmostEqual(self.body("second/chassis").position[1], 4.0, 2)
        with visum.Client(self.daemon.connect, name="driver") as driver:
            cart = driver.part("second")
            cart.acquire()
            self.assertIn("leased by 'driver'", self.daemon.visum("remove", "second", expect=1).stderr)
            first = cart.input_ports[0]
            cart.inputs(first.name).set([first.initial])
            cart.write()
            self.client.advance_ms(10)
            cart.release()
        taken = self.daemon.visum("spawn", "cart/cart.yaml", "--name", "second", expect=2)
        self.assertIn("the name 'second' is taken", taken.stderr)
        again = self.client.spawn("cart/cart.yaml", "second", position_m=(0, 6, 0), unique=True)
        self.assertEqual(again.name, "second_2")
        self.assertEqual(self.client.spawned_models(), ["second", "second_2"])
        self.daemon.visum("remove", "second")
        self.client.remove_model("second_2")
        self.daemon.visum("remove", "ball")
        self.assertEqual(self.client.part_names(), ["arm"])
        self.assertIn("did you mean 'cart/cart.yaml'", self.daemon.visum("spawn", "cart/cart.yml", expect=2).stderr)
        self.assertIn("no spawned model 'second'", self.daemon.visum("remove", "second", expect=2).stderr)
        told = [json.loads(line)["kind"] for line in self.daemon.visum("events", "--json").stdout.splitlines()]
        self.assertIn("spawn", told)
        self.assertIn("remove", told)

    def test_a_model_of_the_clients_own_comes_with_the_files_that_it_names(self):
        folder = pathlib.Path(self.folder) / "robots"
        (folder / "meshes").mkdir(parents=True)
        (folder / "meshes" / "wedge.stl").write_text(WEDGE)
        robot = folder / "arm.urdf"
        robot.write_text(ROBOT)
        self.daemon.visum("recording", "start", "monday")
        self.assertIn("stick: 2 bodies, parts: stick", self.daemon.visum("spawn", robot, "--name", "stick").stdout)
        file, files = visum.model_files(robot)
        self.assertEqual((file, sorted(files)), ("arm.urdf", ["arm.urdf", "meshes/wedge.stl"]))
        self.client.spawn(file, "other", position_m=(0, 5, 1), files=files)
        robot.unlink()  # the server has it all
        self.client.advance_ms(50)
        self.daemon.visum("remove", "stick")
        self.client.advance_ms(50)
        self.daemon.visum("recording", "stop")
        replayed = json.loads(run_visum("replay", pathlib.Path(self.folder) / "monday.mcap", "--json").stdout)
        self.assertTrue(replayed["equal"])
        self.daemon.visum("snapshot", "--name", "both")
        before = self.client.status().state_hash
        self.client.reset("all")
        self.assertEqual(self.client.part_names(), ["arm"])
        self.client.restore_snapshot("both")
        self.assertEqual(self.client.status().state_hash, before)
        self.assertEqual(self.client.part_names(), ["arm", "other"])
        del files["meshes/wedge.stl"]
        files[file] = files[file].replace(b"<visual>", b"<collision>").replace(b"</visual>", b"</collision>")
        with self.assertRaises(visum.Error) as refused:
            self.client.spawn(file, "third", position_m=(0, 8, 1), files=files)
        self.assertIn("wedge.stl", str(refused.exception))

    def test_another_scene_takes_the_worlds_place(self):
        self.assertIn("cart_fleet", self.client.scenes())
        self.assertIn("pick_and_place", self.client.scenarios())
        listed = self.daemon.json("scenes")
        self.assertEqual((listed["scenes"], listed["scenarios"]), (self.client.scenes(), self.client.scenarios()))
        self.assertRegex(self.daemon.visum("scenes").stdout, r"scene +cart\n")
        self.daemon.visum("recording", "start", "monday")
        self.client.advance_ms(50)
        self.daemon.visum("load", "cart")
        self.assertEqual(self.client.part_names(), ["cart"])
        self.client.advance_ms(50)
        self.assertEqual((self.client.status().tick, self.client.status().era), (50, 2))
        with visum.Client(self.daemon.connect, name="driver") as driver:
            cart = driver.part("cart")
            cart.acquire()
            self.client.advance_ms(10)
            self.client.load_scene("amtec_arm")
            with self.assertRaises(visum.Error) as lost:
                cart.read()
            self.assertEqual(lost.exception.code, visum.ErrorCode.UNKNOWN_NAME)
        self.assertEqual(self.client.part_names(), ["arm"])
        self.client.advance_ms(100)
        last = self.client.status().state_hash
        self.daemon.visum("recording", "stop")
        replayed = json.loads(run_visum("replay", pathlib.Path(self.folder) / "monday.mcap", "--json").stdout)
        self.assertTrue(replayed["equal"])
        # A server that has this scene from the beginning comes to the same state.
        with Daemon("--clock", "lockstep", "--files", self.folder) as other:
            with visum.Client(other.connect, name="steps") as alone:
                alone.join()
                alone.advance_ms(100)
                self.assertEqual(alone.status().state_hash, last)
        self.assertIn("did you mean 'cart'", self.daemon.visum("load", "carts", expect=2).stderr)
        self.assertIn("no scene '../secret'", self.daemon.visum("load", "../secret", expect=2).stderr)
        told = [json.loads(line) for line in self.daemon.visum("events", "--json").stdout.splitlines()]
        self.assertIn("the scene 'cart' was loaded", [event["text"] for event in told if event["kind"] == "load"])

    def test_a_snapshot_with_a_name_outlives_the_server(self):
        self.client.advance_ms(150)
        self.daemon.visum("snapshot", "--name", "gripped")
        before = self.client.status().state_hash
        self.client.advance_ms(100)
        self.daemon.visum("restore", "gripped")
        self.assertEqual(self.client.status().state_hash, before)
        self.client.close()
        with Daemon("--clock", "lockstep", "--files", self.folder) as again:
            again.visum("restore", "gripped")
            status = again.json("status")
            self.assertEqual(int(status["state_hash"], 16), before)
            self.assertEqual(status["tick"], 150)
            self.assertIn("there is no snapshot 'grip'", again.visum("restore", "grip", expect=2).stderr)
            self.assertIn("begins with a letter", again.visum("snapshot", "--name", "9lives", expect=2).stderr)
        with Daemon("--clock", "lockstep", "--files", self.folder, "--seed", "7") as other:
            self.assertIn("another seed", other.visum("restore", "gripped", expect=2).stderr)

    def test_a_recording_is_started_and_stopped_while_the_world_runs(self):
        self.client.advance_ms(50)
        self.daemon.visum("recording", "start", "monday")
        self.assertIn("under way already", self.daemon.visum("recording", "start", "tuesday", expect=1).stderr)
        self.client.set_body("ball", (1, 1, 3))
        self.client.advance_ms(200)
        self.daemon.visum("recording", "stop")
        self.assertIn("no client has started", self.daemon.visum("recording", "stop", expect=1).stderr)
        replayed = json.loads(run_visum("replay", pathlib.Path(self.folder) / "monday.mcap", "--json").stdout)
        self.assertTrue(replayed["equal"])
        self.assertEqual(replayed["ticks"], 200)


if __name__ == "__main__":
    unittest.main()
