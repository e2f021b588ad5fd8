import assert from "node:assert/strict";
import { mock, test } from "node:test";
import { apartInWords, BesideBodies, whereTheyPart, type BesideReport } from "../src/model/beside";
import type { PartDescription, PartSample } from "../src/link/messages";
import { Part } from "../src/model/part";
import { Parts } from "../src/model/parts";
import { Recording } from "../src/model/recording";
import { server, settled } from "./server";

mock.method(globalThis, "setInterval", () => 0); // nothing is asked again and again

const kNothing: BesideReport = { file: "b.mcap", ticks: 9, compared: 9, over: true, damage: "", settings: [], only_a: [], only_b: [], ports: [], port_count: 0 };
const port = (name: string, position: number) => ({ part: "arm", port: name, position, tick: position, a: "1", b: "2.5", max_abs: "3", max_tick: 8 });

test("it is said where two recordings part, at which ports, and what they lack", () => {
  const words = (more: Partial<BesideReport>) => whereTheyPart(9, { ...kNothing, ...more });
  assert.equal(words({}), "Equal: all 9 ticks.");
  assert.equal(words({ over: false, compared: 4 }), "Compared with b.mcap: equal in 4 of 9 ticks so far.");
  assert.equal(words({ only_b: ["arm/X"] }), "Not the same ports; those that both have are equal in all ticks.");
  assert.equal(words({ first: { position: 5, tick: 5 }, ports: [port("X", 5), port("Y", 7)], port_count: 2 }), "They part at tick 5. arm, X: A 1, B 2.5.");
  const many = ["X", "Y", "Z", "W"].map((name) => ({ ...port(name, 5), a: "-0.006404863500516303", b: "1e-05" }));
  assert.equal(words({ first: { position: 5, tick: 5 }, ports: many, port_count: 4 }), "They part at tick 5. arm, X: A -0.00640486, B 1.000e-5; arm, Y: A -0.00640486, B 1.000e-5; 2 more.");
  assert.equal(words({ first: { position: 4, tick: 4 }, ports: [port("X", 5)], port_count: 1 }), "They part at tick 4. The state differs there, and no port yet.");
  assert.equal(words({ first: { position: 8, tick: 8 }, ticks: 7 }), "They part at tick 8. No port differs, but the state or the length does. A has 9 ticks, B 7.");
  assert.equal(words({ over: true, damage: "b.mcap: cut off" }), "Equal: all 9 ticks. It ends there: b.mcap: cut off.");
});

test("bodies that are apart are named, the farthest first", () => {
  const names = ["floor", "box", "hand", "ball", "cup"];
  const apart = [[0, 0], [0.0123, 0], [0, 0.5], [NaN, NaN], [1.5, 0]].map(([metres, radians]) => ({ metres: metres!, radians: radians! }));
  assert.equal(apartInWords(names, apart, 2), "cup 1.50 m, box 12.3 mm, 1 more; not in B: ball");
  assert.equal(apartInWords(names, apart, 3), "cup 1.50 m, box 12.3 mm, hand turned 28.6°; not in B: ball");
  assert.equal(apartInWords(["box"], [{ metres: 1e-9, radians: 0 }], 3), "box less than 0.1 mm");
  assert.equal(apartInWords(["box"], [{ metres: 0, radians: 0 }], 3), "all bodies are where they are in A");
});

test("B's bodies are drawn at the simulated time of A's", () => {
  const bodies = new BesideBodies();
  const take = (position: number, x: number) => bodies.take(new Uint8Array(new Float64Array([position, position / 1000, x, 0, 0, 1, 0, 0, 0, 0.25, 0]).buffer));
  take(10, 1);
  take(20, 2);
  const out = new Float64Array(7);
  assert.ok(bodies.posesAt(15, out));
  assert.equal(out[0], 1.5);
  assert.deepEqual([bodies.position, bodies.apart], [20, [{ metres: 0.25, radians: 0 }]]);
});

// Recordings of one part, of which one port is plotted; `asked`: what was read of the files.
async function two(position: number) {
  const asked: string[] = [];
  const rows = (url: string) => new Float64Array(url.includes("beside") ? [0.001, 5, 0.002, 6] : [0.001, 1, 0.002, 2, 0.003, 3]);
  mock.method(globalThis, "fetch", async (url: string) => (asked.push(url), { ok: true, arrayBuffer: async () => rows(url).buffer }));
  const report = { file: "a.mcap", ticks: 9000, tick_ns: 1e6, position, compared: 0, equal: true, damage: "", beside: { ...kNothing, ticks: 9000 } };
  const { link } = server((request) => (request.case === "readBlackboard" ? { data: new TextEncoder().encode(JSON.stringify(report)) } : {}));
  Object.assign(link, { recorded: { value: false }, headers: {} });
  const parts = new Parts(link);
  const part = new Part(link, { name: "arm", parameters: [], controllerInputs: [{ name: "X" }], sensorOutputs: [] } as unknown as PartDescription);
  parts.list.value = [part];
  const recording = new Recording(link, parts);
  mock.method(recording.bodies, "take", () => undefined);
  await recording.begin("recording");
  part.record(part.ports);
  return { asked, link, parts, part, recording, report };
}

test("a plot gets both recordings while they stand, and B's ahead of A while they play", async () => {
  const { asked, parts, part, recording } = await two(3);
  assert.equal(parts.beside.value, "b.mcap");
  await parts.plotted();
  await settled();
  await settled();
  assert.deepEqual(asked, ["/recording/ports/0/3/10000", "/recording/beside/ports/0/3/10000"]);
  assert.deepEqual(part.besides()!.all([0]), { times: [0.001, 0.002], values: [[5, 6]] });
  const late = { controllerInputs: [1], sensorOutputs: [], conflated: 0n, simTimeNs: 2_000_000n, era: -1n };
  part.take(late as unknown as PartSample);
  assert.deepEqual(part.recordings()!.all([0]).times, [0.001, 0.002, 0.003]);
  recording.playing = true;
  await recording.refresh();
  assert.deepEqual(asked.slice(2), ["/recording/beside/ports/0/5003/5000"], "what comes after that");
  await recording.refresh();
  assert.equal(asked.length, 3, "it is far enough ahead");
});

test("B's plot goes on after a reset that was recorded", async () => {
  const { part } = await two(3);
  part.refillBeside(new Float64Array([4.9, 1, 5, 2]), true);
  part.refillBeside(new Float64Array([0.001, 3, 0.002, 4]), false);
  part.refillBeside(new Float64Array([0.003, 5]), false);
  assert.deepEqual(part.besides()!.all([0]), { times: [0.001, 0.002, 0.003], values: [[3, 4, 5]] });
});

test("a part that the recordings do not have keeps no other from its plot", async () => {
  const { asked, link, parts, part, recording } = await two(3);
  const gone = new Part(link, { ...part.description, name: "gone" });
  gone.record(gone.ports);
  parts.list.value = [gone, part];
  const fetched = globalThis.fetch;
  mock.method(globalThis, "fetch", async (url: string) => (/ports\/0/.test(url) ? { ok: false } : fetched(url)));
  await recording.refresh();
  await parts.plotted();
  await settled();
  await settled();
  assert.deepEqual(part.recordings()!.all([0]).times, [0.001, 0.002, 0.003]);
  assert.deepEqual(part.besides()!.all([0]).times, [0.001, 0.002]);
  const before = asked.length;
  await recording.refresh();
  assert.equal(asked.length, before, "not again and again");
});

test("what is plotted while they play is filled from before this position, too", async () => {
  const { part, recording, asked } = await two(3);
  recording.playing = true;
  await recording.refresh();
  assert.deepEqual(asked, ["/recording/beside/ports/0/5003/10000"]);
  assert.ok(part.besides());
});
