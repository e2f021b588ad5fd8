import assert from "node:assert/strict";
import { test } from "node:test";
import { Matrix4, Vector3 } from "three";
import type { JointDescription } from "../src/link/messages";
import { divergencePorts, ghostBodies, ghostPose } from "../src/view3d/ghost_pose";

const kBodies = ["table", "base", "upper", "lower", "finger", "tool"];
const bodyOf = (name: string) => kBodies.indexOf(name);
const joint = (name: string, type: string, parent: string, child: string, part = "arm", x = 0, axis = [0, 0, 1]) =>
  ({ name, type, parent, child, part, pose: [x, 0, 0, 1, 0, 0, 0], axis }) as unknown as JointDescription;

// Not in the order of the chain; the tool hangs on the lower arm by a joint that no part drives.
const kJoints = [
  joint("grip", "slider", "lower", "finger", "arm", 1, [0, 1, 0]),
  joint("mount", "fixed", "lower", "tool", ""),
  joint("elbow", "hinge", "upper", "lower", "arm", 1),
  joint("shoulder", "hinge", "base", "upper"),
  joint("foot", "fixed", "", "base", ""),
];
const port = (name: string, unit: string) => ({ name, unit });

test("each joint finds the port of its own kind, in their order", () => {
  const ports = [port("Divergence of Actual Angle 1", "rad"), port("Divergence of Actual Angle 2", "rad"), port("Divergence of Actual Position", "m"),
    port("Largest Angle Divergence", "rad"), port("Largest Position Divergence", "m")];
  assert.deepEqual(divergencePorts(kJoints, "arm", ports), [2, -1, 0, 1, -1]);
  assert.deepEqual(divergencePorts(kJoints, "arm", ports.slice(1)), [1, -1, -1, -1, -1], "too few angles: none is guessed");
});

test("the ghost has what the part's joints move, each body behind its parent, and not the base", () => {
  const found = ghostBodies(kJoints, "arm", bodyOf);
  assert.deepEqual(found.map(({ body }) => kBodies[body]).sort(), ["finger", "lower", "tool", "upper"]);
  const at = (name: string) => found.findIndex(({ body }) => kBodies[body] === name);
  assert.ok(at("upper") < at("lower") && at("lower") < at("finger") && at("lower") < at("tool"));
  assert.deepEqual(ghostBodies(kJoints, "another", bodyOf), []);
});

// Two links of length 1 in a plane, from the origin: shown at angles a, the ghost apart from them.
test("the ghost stands where the kinematics of its own angles put it", () => {
  const shown = (shoulder: number, elbow: number) => {
    const upper = new Matrix4().makeRotationZ(shoulder);
    const lower = upper.clone().multiply(new Matrix4().makeTranslation(1, 0, 0)).multiply(new Matrix4().makeRotationZ(elbow));
    const finger = lower.clone().multiply(new Matrix4().makeTranslation(1, 0.02, 0));
    return { upper, lower, finger };
  };
  const [is, apart] = [[0.3, -0.8], [0.2, 0.5]];
  const now = shown(is[0]!, is[1]!);
  const wanted = shown(is[0]! + apart[0]!, is[1]! + apart[1]!);
  const upper = ghostPose(kJoints[3]!, apart[0]!, new Matrix4(), new Matrix4(), now.upper);
  const lower = ghostPose(kJoints[2]!, apart[1]!, upper, now.upper, now.lower);
  const finger = ghostPose(kJoints[0]!, 0.01, lower, now.lower, now.finger);
  const tip = (of: Matrix4, y = 0) => new Vector3(1, y, 0).applyMatrix4(of);
  assert.ok(tip(lower).distanceTo(tip(wanted.lower)) < 1e-12);
  assert.ok(tip(finger).distanceTo(tip(wanted.finger, 0.01)) < 1e-12, "a slider goes along its axis");
});
