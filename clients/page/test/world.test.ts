import assert from "node:assert/strict";
import { test } from "node:test";
import type { Body, WorldDescription, WorldSample } from "../src/link/messages";
import { World } from "../src/model/world";
import { server, settled } from "./server";

const describe = (revision: bigint, ...names: string[]) => ({ revision, bodies: names.map((name) => ({ name })) }) as unknown as WorldDescription;
const sampleOf = (revision: bigint, simTimeNs: bigint, ...x: number[]) =>
  ({ revision, simTimeNs, era: 0n, poses: x.flatMap((at) => [at, 0, 0, 1, 0, 0, 0]) }) as unknown as WorldSample;
const kChanged = { case: "event", value: { kind: "world_changed" } } as Body;
const sampled = (sample: WorldSample) => ({ case: "worldSample", value: sample }) as Body;

// A world that stands at 1 s, with the bodies a (at 1) and b (at 2).
async function standing() {
  const now = { description: describe(1n, "a", "b"), sample: sampleOf(1n, 1_000_000_000n, 1, 2) };
  const { link, tell } = server((request) => (request.case === "describeWorld" ? now.description : request.case === "readWorld" ? now.sample : {}));
  const world = new World(link);
  await world.begin();
  const xOf = (body: number) => {
    const poses = new Float64Array(7 * world.description.value!.bodies.length);
    return world.posesAt(performance.now(), poses) ? poses[7 * body] : undefined;
  };
  return { now, tell, world, xOf };
}

test("while time stands, bodies are where they are as soon as they are known", async () => {
  const { xOf } = await standing();
  assert.deepEqual([xOf(0), xOf(1)], [1, 2]);
});

test("when a body goes, the others keep their places, though time stands", async () => {
  const { now, tell, world, xOf } = await standing();
  Object.assign(now, { description: describe(2n, "b"), sample: sampleOf(2n, 1_000_000_000n, 2) });
  tell(kChanged);
  await settled();
  assert.equal(xOf(world.bodyIndex("b")), 2);
  assert.deepEqual(world.sample?.poses.slice(0, 1), [2]);
});

test("a sample of as many other bodies is not taken", async () => {
  const { tell, world, xOf } = await standing();
  tell(sampled(sampleOf(2n, 1_001_000_000n, 8, 9)));
  assert.deepEqual([xOf(0), world.sample?.revision], [1, 1n]);
});
