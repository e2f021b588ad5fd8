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
