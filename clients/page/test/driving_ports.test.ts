import assert from "node:assert/strict";
import { test } from "node:test";
import type { JointDescription } from "../src/link/messages";
import type { Port } from "../src/model/part";
import { portsOfJoint } from "../src/view3d/driving_ports";

const joint = (name: string, type: string) => ({ name, type }) as JointDescription;
const port = (name: string, group: string, unit: string) => ({ description: { name, group, unit } }) as Port;

// Two hinges, then a slider between them and a third hinge: the order of joints, not of kinds.
const kJoints = [joint("j1", "hinge"), joint("j2", "hinge"), joint("f1", "slider"), joint("j3", "hinge")];
const kPorts = [
  ...[1, 2, 3].map((i) => port(`Desired Angle ${i}`, "Desired Angle", "rad")),
  ...[1, 2, 3].map((i) => port(`Maximum Speed ${i}`, "Maximum Speed", "rad/s")),
  port("Desired Finger 1", "Desired Finger", "m"),
  port("Reset", "", ""),
];
const namesOf = (index: number) => portsOfJoint(kJoints[index]!, kJoints, kPorts).map((found) => found.description.name);

test("a hinge has its own angle and speed", () => {
  assert.deepEqual(namesOf(1), ["Desired Angle 2", "Maximum Speed 2"]);
  assert.deepEqual(namesOf(3), ["Desired Angle 3", "Maximum Speed 3"]);
});

test("a joint whose kind has no group of ports has none", () => {
  assert.deepEqual(namesOf(2), []);
});
