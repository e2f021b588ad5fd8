import assert from "node:assert/strict";
import { test } from "node:test";
import { ErrorCode, LostError, type PartDescription, type PartSample, type RequestInit } from "../src/link/messages";
import { neighbours } from "../src/model/neighbours";
import { Part } from "../src/model/part";
import { refusal, server, settled } from "./server";

const kInputs = ["Angle", "Finger 1", "Finger 2", "Speed"];
const kDescription = {
  name: "arm",
  controllerInputs: kInputs.map((name) => ({ name })),
  sensorOutputs: kInputs.map((name) => ({ name: `Actual ${name}` })),
} as unknown as PartDescription;
const sampleOf = (...controllerInputs: number[]) =>
  ({ controllerInputs, sensorOutputs: [], conflated: 0n, simTimeNs: 0n, era: 0n }) as unknown as PartSample;

// A part that this page leases, with values held; `writes`: first port and values of each write.
async function leased(held: [number, number][], refuse: () => Error | undefined = () => undefined,
  refuseRelease: () => Error | undefined = () => undefined) {
  const { asked, link } = server((request) => {
    const error = (request.case === "write" && refuse()) || (request.case === "releaseLease" && refuseRelease());
    if (error) throw error;
    return {};
  });
  const part = new Part(link, kDescription);
  const told: string[] = [];
  part.gaveUp.on((words) => told.push(words));
  await part.acquire();
  for (const [index, value] of held) part.held.set(index, value);
  const writes = () => asked.flatMap((request: RequestInit) => (request.case === "write" ? [[request.value.firstPort, ...request.value.values!]] : []));
  return { part, told, writes };
}

test("a held port takes no other value, from wherever in a message", async () => {
  const { part, writes } = await leased([[2, 0.02]]);
  await assert.rejects(part.write(part.port("Finger 2")!, 0.03), /'Finger 2' is held at 0\.02/);
  await assert.rejects(part.writeValues(part.port("Finger 1")!, [0.03, 0.03]), /'Finger 2' is held at 0\.02/);
  assert.deepEqual(writes(), []);
  await part.writeValues(part.port("Finger 1")!, [0.02, 0.02]);
  assert.deepEqual(writes(), [[1, 0.02, 0.02]]);
});

test("ports are cut into neighbours, in whatever order they come, and each part's by themselves", () => {
  const parts = ["arm", "other arm"].map((name) => new Part(server().link, { ...kDescription, name }));
  const ports = parts.flatMap((part) => ["Speed", "Finger 1", "Actual Finger 2", "Angle"].map((name) => part.port(name)!));
  const runs = neighbours(ports).map((run) => run.map(({ description }) => description.name).join());
  assert.deepEqual(runs, ["Angle,Finger 1", "Speed", "Actual Finger 2", "Angle,Finger 1", "Speed", "Actual Finger 2"]);
});

test("sensor outputs are not written, nor inputs in their place", async () => {
  const { part, writes } = await leased([]);
  await assert.rejects(part.writeValues(part.port("Actual Finger 1")!, [1, 1]), /'Actual Finger 1' is a sensor output/);
  assert.deepEqual(writes(), []);
});

test("held neighbours that others moved are put back in one message, once", async () => {
  const { part, writes } = await leased([[2, 0.02], [3, 5], [1, 0.02]]);
  part.take(sampleOf(0, 0, 0.02, 5));
  part.take(sampleOf(0, 0, 0.02, 5)); // before the answer
  assert.deepEqual(writes(), [[1, 0.02, 0.02, 5]]);
  await settled();
  part.take(sampleOf(0, 0.02, 0.02, 5));
  assert.equal(writes().length, 1);
});

test("a hold that is refused is given up, and told", async () => {
  const { part, told } = await leased([[1, 0.02]], () => refusal(ErrorCode.ERROR_BAD_VALUE, "both must be equal"));
  part.take(sampleOf(0, 0, 0, 0));
  await settled();
  assert.equal(part.held.size, 0);
  assert.deepEqual(told, ["No longer held: Finger 1 (both must be equal)"]);
});

test("a hold outlasts a server that is busy, and a connection that went", async () => {
  const errors = [refusal(ErrorCode.ERROR_BUSY, "too many"), new LostError("gone")];
  const { part, told, writes } = await leased([[0, 1]], () => errors.shift());
  for (let i = 0; i < 3; ++i) {
    part.take(sampleOf(0, 0, 0, 0));
    await settled();
  }
  assert.equal(writes().length, 3);
  assert.ok(part.held.has(0));
  assert.deepEqual(told, []);
});

test("holds end with the lease, which is told where it was lost, and not where it was released", async () => {
  const lost = await leased([[0, 1], [3, 5]]);
  lost.part.leaseLost();
  assert.deepEqual(lost.told, ["No longer held: Angle, Speed (the lease of 'arm' is lost)"]);
  const gone = await leased([[0, 1]], () => undefined, () => refusal(ErrorCode.ERROR_NO_LEASE, "leased by nobody"));
  await gone.part.release();
  assert.deepEqual(gone.told, ["No longer held: Angle (the lease of 'arm' is lost)"]);
  const released = await leased([[0, 1]]);
  await released.part.release();
  assert.deepEqual([released.part.held.size, released.told], [0, []]);
});
