"""A robot without data of its drives, from a bare URDF: its ideal joints press on a wall with no more than the model's effort."""
import os
import pathlib
import sys
import tempfile
import unittest

from programs import BIN, Daemon

sys.path.insert(0, str(BIN.parent / "python"))
os.environ.setdefault("VISUM_BIN", str(BIN))
import visum  # noqa: E402

EFFORT = 30.0  # N·m
URDF = f"""<robot name="rod">
  <link name="base"/>
  <link name="arm">
    <inertial><origin xyz="0.25 0 0"/><mass value="2"/>
      <inertia ixx="0.01" iyy="0.05" izz="0.05" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><origin xyz="0.25 0 0"/><geometry><box size="0.5 0.05 0.05"/></geometry></collision>
  </link>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="arm"/><origin xyz="0 0 0.5"/><axis xyz="0 0 1"/>
    <limit lower="-3" upper="3" effort="{EFFORT}" velocity="2"/></joint>
</robot>
"""
SCENE = """visum: 1
name: cell
models:
  - {name: rod, file: rod.urdf}
bodies:
  - {name: wall, fixed: true, pose: {xyz: [0.3, 0.25, 0.5]}, shapes: [{box: [0.05, 0.05, 0.4]}]}
parts:
  - {name: rod, kind: ideal_joints, model: rod}
"""


class IdealArm(unittest.TestCase):
    def test_it_stops_at_a_wall_and_comes_back(self):
        with tempfile.TemporaryDirectory() as folder:
            scene = pathlib.Path(folder) / "cell.yaml"
            scene.write_text(SCENE)
            (scene.parent / "rod.urdf").write_text(URDF)
            with Daemon("--clock", "lockstep", scene=scene) as daemon, visum.Client(daemon.connect) as client:
                rod = client.part("rod")
                with rod.lease():
                    client.join()
                    desired, angle, effort = rod.inputs("Desired Angle"), rod.outputs("Actual Angle"), rod.outputs("Actual Effort")
                    for target in (1.5, -0.5):
                        desired[0] = target
                        for _ in range(200):
                            rod.write()
                            client.advance_ticks(10)
                        if target > 0:
                            # The wall's near edge touches the rod's side.
                            self.assertAlmostEqual(angle[0], 0.542, delta=0.01)
                            self.assertAlmostEqual(effort[0], EFFORT, delta=0.01 * EFFORT)
                    self.assertAlmostEqual(angle[0], -0.5, delta=1e-6)


if __name__ == "__main__":
    unittest.main()
