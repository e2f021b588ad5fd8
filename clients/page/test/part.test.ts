import assert from "node:assert/strict";
import { test } from "node:test";
import { ErrorCode, LostError, type PartDescription, type PartSample, type RequestInit } from "../src/link/messages";
import { neighbours } from "../src/model/neighbours";
import { Part } from "../src/model/part";
import { refusal, server, settled } from "./server";

const kInputs = ["Angle", "Finger 1", "Finger 2", "Speed"];
const kDescription = {
  name: "arm",
  parameters: [],
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

test("what was recorded goes with another era, and with another server", () => {
  const part = new Part(server().link, kDescription);
  part.record([part.port("Angle")!]);
  const take = (seconds: number, era: bigint) => {
    part.take({ ...sampleOf(0, 0, 0, 0), simTimeNs: BigInt(seconds * 1e9), era });
    return part.recordings()!.all([0]).times;
  };
  assert.deepEqual([take(1, 1n), take(2, 1n)], [[1], [1, 2]]);
  assert.deepEqual(take(1, 1n), [1, 2], "late");
  part.forgetSubscription();
  assert.deepEqual(take(3, 1n), [1, 2, 3], "the same server");
  part.forgetSubscription();
  assert.deepEqual(take(1, 1n), [1], "another one");
  assert.deepEqual(take(0, 2n), [0], "a reset");
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

// A part of 60 ports, and what it shows of them at a time in s: 100 times the port's place, and the time.
function wide() {
  const description = { name: "arm", parameters: [], controllerInputs: [], sensorOutputs: Array.from({ length: 60 }, (_, i) => ({ name: `Out ${i}` })) };
  const part = new Part(server().link, description as unknown as PartDescription);
  const goes = (seconds: number) => part.take({ ...sampleOf(), sensorOutputs: part.ports.map(({ index }) => 100 * index + seconds), simTimeNs: BigInt(Math.round(1e9 * seconds)) } as PartSample);
  const seen = (i: number) => part.recordings()!.all([part.channel(part.ports[i]!)]).values[0];
  return { part, goes, seen };
}

test("too many ports are refused as a whole, and nothing of them stays", () => {
  const { part } = wide();
  assert.throws(() => part.record(part.ports), /at most 48 ports of 'arm' are recorded at a time/);
  assert.ok(!part.isPlotted);
  const stop = part.record(part.ports.slice(0, 48));
  assert.throws(() => part.record(part.ports.slice(48, 49)), /at most 48/);
  stop();
  assert.ok(!part.isPlotted);
});

test("a port that nobody plots any more makes room for another, which knows nothing of it", () => {
  const { part, goes, seen } = wide();
  part.record(part.ports.slice(1, 48));
  const stop = part.record(part.ports.slice(0, 2));
  goes(1);
  stop();
  part.record([part.ports[50]!]);
  goes(2);
  assert.deepEqual([seen(50), seen(1)], [[null, 5002], [101, 102]]);
  assert.equal(part.channel(part.ports[0]!), -1);
  assert.throws(() => part.record([part.ports[0]!]), /at most 48/);
});

test("what was written last is what is commanded, until a later sample has come or it was refused", async () => {
  const errors: (Error | undefined)[] = [];
  const { part } = await leased([], () => errors.shift());
  const speed = part.port("Speed")!;
  part.take(sampleOf(0, 0, 0, 1));
  const written = part.write(speed, 2);
  assert.equal(part.commanded(speed), 2);
  await written;
  part.take(sampleOf(0, 0, 0, 1)); // of the same tick
  assert.equal(part.commanded(speed), 2);
  part.take({ ...sampleOf(0, 0, 0, 1), simTimeNs: 1_000_000n } as PartSample);
  assert.equal(part.commanded(speed), 1);
  errors.push(refusal(ErrorCode.ERROR_BAD_VALUE, "too fast"));
  await assert.rejects(part.write(speed, 9), /too fast/);
  assert.equal(part.commanded(speed), 1);
  await part.write(speed, 3);
  errors.push(refusal(ErrorCode.ERROR_BAD_VALUE, "too fast"), refusal(ErrorCode.ERROR_BAD_VALUE, "too fast"));
  await Promise.allSettled([part.write(speed, 9), part.write(speed, 10)]);
  assert.equal(part.commanded(speed), 3);
});
