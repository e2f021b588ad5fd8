import assert from "node:assert/strict";
import { mock, test } from "node:test";
import type { PartDescription } from "../src/link/messages";
import { Part } from "../src/model/part";
import { Parts } from "../src/model/parts";
import { Recording } from "../src/model/recording";
import { server, settled } from "./server";

mock.method(globalThis, "setInterval", () => 0); // nothing is asked again and again

const kReport = { file: "f", ticks: 9, tick_ns: 1e6, position: 3, compared: 0, equal: true, damage: "" };

// A recording of one part, one port of which is plotted; `asked`: what was read of the file. `meanwhile` runs
// before the answer.
async function plotted(meanwhile = (): unknown => undefined) {
  const asked: string[] = [];
  mock.method(globalThis, "fetch", async (url: string) => {
    asked.push(url);
    meanwhile();
    return { ok: true, arrayBuffer: async () => new ArrayBuffer(0) };
  });
  const { link } = server((request) => (request.case === "readBlackboard" ? { data: new TextEncoder().encode(JSON.stringify(kReport)) } : {}));
  Object.assign(link, { recorded: { value: false }, headers: {} });
  const parts = new Parts(link);
  const part = new Part(link, { name: "arm", parameters: [], controllerInputs: [{ name: "X" }], sensorOutputs: [] } as unknown as PartDescription);
  parts.list.value = [part];
  const recording = new Recording(link, parts);
  await recording.begin("recording");
  part.record(part.ports);
  return { asked, parts, recording };
}

test("plots are filled from the recording when they change, and not when its pace does", async () => {
  const { asked, parts } = await plotted();
  await parts.adaptTo(1);
  await settled();
  assert.deepEqual(asked, []);
  await parts.plotted();
  await settled();
  assert.deepEqual(asked, ["/recording/ports/0/3/10000"]);
});

test("while a recording plays, nothing is read of what was", async () => {
  const { asked, parts, recording } = await plotted();
  recording.playing = true;
  await parts.plotted();
  await settled();
  assert.deepEqual(asked, []);
  recording.playing = false;
  await recording.refresh();
  assert.equal(asked.length, 1);
});

test("plots that an answer came too late for are filled at the next look, and once", async () => {
  const { asked, parts, recording } = await plotted(() => (recording.position.value = asked.length === 1 ? 2 : 3));
  await parts.plotted();
  await settled();
  assert.deepEqual(asked, ["/recording/ports/0/3/10000"]);
  await recording.refresh();
  await recording.refresh();
  assert.deepEqual(asked.slice(1), ["/recording/ports/0/3/10000"]);
});
