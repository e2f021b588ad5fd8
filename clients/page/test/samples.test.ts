// The reader of samples gives what the general decoder gives, for every sample that there can be.
import assert from "node:assert/strict";
import { test } from "node:test";
import { create, equals, fromBinary, toBinary, type MessageInitShape } from "@bufbuild/protobuf";
import { decode, ServerMessageSchema } from "../src/link/messages";
import { readSample } from "../src/link/samples";

type Init = MessageInitShape<typeof ServerMessageSchema>;
const bytesOf = (init: Init) => toBinary(ServerMessageSchema, create(ServerMessageSchema, init));

let seed = 1; // numbers that are the same in each run
const random = () => (seed = (seed * 48271) % 2147483647) / 2147483647;
const kDoubles = [0, -0, 1.5, -1e300, Number.MIN_VALUE, Infinity, NaN, Math.PI];
const doubles = (most: number) => Array.from({ length: Math.floor(random() * most) }, () => (random() < 0.3 ? kDoubles[Math.floor(random() * kDoubles.length)]! : random()));
const kWhole = [0n, 1n, 127n, 128n, 2n ** 28n - 1n, 2n ** 28n, 2n ** 53n - 1n, 2n ** 53n + 1n, 2n ** 56n, 2n ** 63n - 1n];
const whole = () => kWhole[Math.floor(random() * kWhole.length)]!;
const signed = () => (random() < 0.3 ? -whole() : whole());
const unsigned = () => (random() < 0.2 ? 2n ** 64n - 1n : whole());

function partSample(): Init {
  return { body: { case: "partSample", value: { part: random() < 0.3 ? "Gerät 7" : "arm", tick: signed(), simTimeNs: signed(), era: unsigned(), controllerInputs: doubles(30), sensorOutputs: doubles(60), conflated: unsigned() } } };
}
function worldSample(): Init {
  const contact = () => ({ bodyA: Math.floor(random() * 300), bodyB: Math.floor(random() * 300), position: doubles(4), normal: doubles(4), depth: random() < 0.3 ? 0 : random(), normalForceN: random() });
  return { body: { case: "worldSample", value: {
    tick: signed(), simTimeNs: signed(), era: unsigned(), poses: doubles(99), velocities: doubles(99), jointPositions: doubles(9), jointVelocities: doubles(9), jointEfforts: doubles(9),
    followingErrors: doubles(9), peakFollowingErrors: doubles(9), peakContactForces: doubles(9), contacts: Array.from({ length: Math.floor(random() * 4) }, contact), stateHash: unsigned(), revision: unsigned(), conflated: unsigned(),
  } } };
}

test("samples are read as by the general decoder", () => {
  for (let i = 0; i < 2000; ++i) {
    const bytes = bytesOf(i % 2 === 0 ? partSample() : worldSample());
    const fast = readSample(bytes);
    assert.ok(fast);
    assert.ok(equals(ServerMessageSchema, fast, fromBinary(ServerMessageSchema, bytes)) || hasNaN(bytes), `sample ${i}`);
    assert.deepEqual(fast.body.value, plain(fromBinary(ServerMessageSchema, bytes).body.value), `sample ${i}`);
  }
});

// equals() holds NaN for unlike itself; deepEqual does not
const hasNaN = (bytes: Uint8Array) => JSON.stringify(fromBinary(ServerMessageSchema, bytes).body.value, (_, value) => (typeof value === "bigint" ? "" : typeof value === "number" && Number.isNaN(value) ? "NaN" : value)).includes("NaN");

// A message without the prototype that the general decoder may give it.
function plain(value: unknown): unknown {
  if (Array.isArray(value)) return value.map(plain);
  return typeof value === "object" && value !== null ? Object.fromEntries(Object.entries(value).map(([name, of]) => [name, plain(of)])) : value;
}

test("replies, other messages, fields of later versions and damaged ones are left to the general decoder", () => {
  const sample = partSample().body!;
  assert.equal(readSample(bytesOf({ replyTo: 3n, body: sample })), null);
  assert.equal(readSample(bytesOf({ body: { case: "ok", value: {} } })), null);
  const bytes = bytesOf({ body: { case: "partSample", value: { part: "arm", tick: 5n, controllerInputs: [1, 2] } } });
  const inside = [...bytes.subarray(2), 9 << 3, 5]; // with a field 9, which nobody knows yet
  const later = Uint8Array.from([bytes[0]!, inside.length, ...inside]);
  assert.equal(readSample(later), null);
  assert.equal(decode(later).body.case, "partSample");
  for (let cut = 0; cut < bytes.length; ++cut) assert.equal(readSample(bytes.subarray(0, cut)), null, `cut at ${cut}`);
});
