// Inverse kinematics of three arms, over thousands of poses that are reachable because they come from joint
// values within the limits. The C++ client is tested with the same arms over 30,000 poses, the Python client
// over fewer (tests/clients).
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { forward, jacobian, type ChainJoint } from "../src/kinematics/chain";
import { solve } from "../src/kinematics/inverse";
import { compose, fromRpy, inverse, kIdentity, length, poseOf, rotationBetween, subtract, toRpy, type Vector } from "../src/kinematics/pose";

const kPoses = 3_000;
type Described = Omit<ChainJoint, "frame" | "child"> & { frame: number[] };
const arms = Object.entries(JSON.parse(readFileSync("../../tests/clients/arms.json", "utf8")) as Record<string, Described[]>)
  .map(([name, joints]) => ({ name, joints: joints.map((joint): ChainJoint => ({ ...joint, frame: poseOf(joint.frame), child: kIdentity })) }));

// The generator of Park and Miller: the same numbers everywhere.
function generator(seed: number): () => number {
  return () => (seed = (48271 * seed) % 2147483647) / 2147483647;
}
const anywhere = (joints: ChainJoint[], next: () => number) => joints.map(({ lower, upper }) => lower + next() * (upper - lower));

for (const { name, joints } of arms)
  test(`${name}: every pose that can be reached is found, within the limits`, () => {
    const next = generator(7);
    let worst = 0;
    for (let i = 0; i < kPoses / arms.length; ++i) {
      const target = forward(joints, anywhere(joints, next));
      const { values, reached } = solve(joints, target, anywhere(joints, next));
      assert.ok(reached, `pose ${i}: ${JSON.stringify(target)}`);
      assert.ok(values.every((value, j) => value >= joints[j]!.lower && value <= joints[j]!.upper), `pose ${i}: ${values}`);
      // Judged by the tool's place, not by what the solver says
      const tool = forward(joints, values);
      worst = Math.max(worst, length(subtract(tool.position, target.position)), length(rotationBetween(tool.orientation, target.orientation)));
    }
    assert.ok(worst <= 1e-6, `${worst}`);
  });

test("a pose nearby is reached nearby: the arm does not jump to another solution", () => {
  for (const { joints } of arms) {
    const next = generator(11);
    for (let i = 0; i < 200; ++i) {
      const start = joints.map(({ lower, upper }) => lower + (0.25 + 0.5 * next()) * (upper - lower));
      const near = start.map((value) => value + 0.01 * (next() - 0.5));
      const { values, reached } = solve(joints, forward(joints, near), start, { starts: 1 });
      if (reached) assert.ok(values.every((value, j) => Math.abs(value - start[j]!) < 0.5), `${values} from ${start}`);
    }
  }
});

test("a pose out of reach is told, and the arm points there as far as it can", () => {
  const { joints } = arms[0]!;
  const { reached, positionError, values } = solve(joints, { position: [5, 0, 0.5], orientation: [1, 0, 0, 0] }, joints.map(() => 0.1), { starts: 1 });
  assert.ok(!reached && positionError > 3.5 && positionError < 4.6, `${positionError}`);
  assert.ok(values.every(Number.isFinite));
});

test("the Jacobian is the derivative of the tool's pose", () => {
  const h = 1e-6;
  for (const { joints } of arms) {
    const values = anywhere(joints, generator(3));
    jacobian(joints, values).forEach(({ linear, angular }, i) => {
      const moved = (by: number) => forward(joints, values.map((value, j) => (i === j ? value + by : value)));
      const [a, b] = [moved(-h), moved(h)];
      const difference = (wanted: Vector, found: Vector, by: number) => assert.ok(length(subtract(wanted, found.map((part) => part / by) as Vector)) < 1e-6);
      difference(linear, subtract(b.position, a.position), 2 * h);
      difference(angular, rotationBetween(a.orientation, b.orientation), 2 * h);
    });
  }
});

test("roll, pitch and yaw come back, and so does a pose from its inverse", () => {
  const rpy: Vector = [0.3, -1.1, 2.5];
  assert.ok(length(subtract(toRpy(fromRpy(rpy)), rpy)) < 1e-12);
  const pose = { position: [1, 2, 3] as Vector, orientation: fromRpy(rpy) };
  const back = compose(pose, inverse(pose));
  assert.ok(length(back.position) < 1e-12 && length(rotationBetween(back.orientation, [1, 0, 0, 0])) < 1e-12);
});
