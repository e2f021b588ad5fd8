import "./dom";
import assert from "node:assert/strict";
import { mock, test } from "node:test";
import type { PartDescription, PartSample } from "../src/link/messages";
import { Part } from "../src/model/part";
import { Parts } from "../src/model/parts";
import { emptyPanel, formatPanel, kMostRows, parsePanel, type WidgetData, type WidgetType } from "../src/panels/file";
import { kKinds } from "../src/panels/kinds";
import { PanelView } from "../src/panels/panel_view";
import { bind } from "../src/panels/widget";
import { editorFor } from "../src/tree/editor";
import { all, happens, toasts } from "./dom";
import { server, settled } from "./server";

mock.method(globalThis, "setInterval", () => 0); // nothing is asked or drawn again and again
mock.method(globalThis, "setTimeout", () => 0); // nor do words go away

const kPorts = 60;
const port = (name: string) => ({ name, unit: "", minimum: -1, maximum: 1, group: "" });
const kDescription = {
  name: "arm",
  parameters: [],
  controllerInputs: ["X", "Y", "Z"].map(port),
  sensorOutputs: Array.from({ length: kPorts }, (_, i) => port(`Out ${i}`)),
} as unknown as PartDescription;
const named = (names: string[]) => names.map((name) => ({ part: "arm", port: name }));
const outputs = (from: number, to: number) => Array.from({ length: to - from }, (_, i) => `Out ${from + i}`);
const data = (type: WidgetType, ports: string[], more: Partial<WidgetData> = {}): WidgetData =>
  ({ type, label: "L", x: 0, y: 0, w: 6, h: 2, ports: named(ports), ...more });

// A part that is leased and stands at `inputs`, and what is written to it: first port and values of each
// message.
async function standing(...inputs: number[]) {
  const { asked, link } = server();
  const parts = new Parts(link);
  const part = new Part(link, kDescription);
  parts.list.value = [part];
  await part.acquire();
  const goes = (seconds: number, ...controllerInputs: number[]) =>
    part.take({ controllerInputs, sensorOutputs: Array(kPorts).fill(seconds), conflated: 0n, simTimeNs: BigInt(Math.round(1e9 * seconds)), era: 0n } as unknown as PartSample);
  goes(1, ...inputs);
  const writes = () => asked.splice(0).flatMap((request) => (request.case === "write" ? [[request.value.firstPort, ...request.value.values!]] : []));
  const widget = (type: WidgetType, ports: string[], more: Partial<WidgetData> = {}) => kKinds[type].make(bind(data(type, ports, more), parts));
  return { part, parts, goes, writes, widget };
}

const near = (found: unknown, wanted: number[][]) =>
  assert.deepEqual((found as number[][]).map((write) => write.map((value) => Number(value.toFixed(9)))), wanted);

test("a stick with a spring comes back however a hand goes away, once", async () => {
  const { writes, widget } = await standing(0, 0, 0);
  const area = widget("stick", ["X", "Y", "Z"], { spring: true }).body;
  for (const end of ["pointerup", "pointercancel", "lostpointercapture"]) {
    happens(area, "pointerdown", { pointerId: 1, clientX: 100, clientY: 0 });
    near(writes(), [[0, 1], [1, 1]]);
    happens(area, end);
    happens(area, "lostpointercapture");
    near(writes(), [[0, 0], [1, 0]]);
  }
});

test("a stick with a spring comes back when an arrow key is let go, or focus is lost meanwhile; other keys do nothing", async () => {
  const { writes, widget } = await standing(0, 0, 0);
  const area = widget("stick", ["X", "Y"], { spring: true }).body;
  happens(area, "keyup", { key: "Tab" });
  assert.deepEqual(writes(), []);
  for (const [end, key] of [["keyup", "ArrowRight"], ["blur", ""]] as const) {
    happens(area, "keydown", { key: "ArrowRight" });
    assert.equal(writes().length, 2);
    happens(area, "keyup", { key: "Shift" });
    assert.deepEqual(writes(), []);
    happens(area, end, { key });
    near(writes(), [[0, 0], [1, 0]]);
  }
});

test("what counts from the last value counts from what was written last, until that is in force", async () => {
  const { part, goes, writes, widget } = await standing(0.2, 4, 0);
  const [more] = all(widget("slider", ["X"], { jog: 0.1 }).body, "button").slice(-1);
  for (let i = 0; i < 3; ++i) happens(more!, "click");
  near(writes(), [[0, 0.3], [0, 0.4], [0, 0.5]]);
  const bits = widget("bits", ["Y"]);
  const boxes = all(bits.body, "input");
  for (const i of [0, 1]) {
    boxes[i]!.checked = true;
    happens(boxes[i]!, "change");
  }
  near(writes(), [[1, 5], [1, 7]]);
  bits.update();
  assert.deepEqual(boxes.map(({ checked }) => checked).slice(0, 4), [true, true, true, false]);
  const count = widget("button", ["Z"]).body;
  happens(count, "click");
  happens(count, "click");
  near(writes(), [[2, 1], [2, 2]]);
  happens(all(editorFor({ ...part.port("Z")!, description: { ...part.port("Z")!.description, minimum: 0, maximum: 9 } }).element, "button")[0]!, "click");
  near(writes(), [[2, 3]]);
  await settled();
  goes(1.001, 0.5, 7, 9); // somebody else counts, too
  happens(count, "click");
  near(writes(), [[2, 10]]);
});

test("scopes with more ports than can be recorded show those that can be, and the page goes on", async () => {
  const { part, parts } = await standing(0, 0, 0);
  const later: number[] = [];
  const view = new PanelView({ ...emptyPanel(), widgets: [data("scope", outputs(0, 40)), data("scope", outputs(40, 60))] }, parts);
  parts.list.watch((list) => later.push(list.length));
  parts.list.value = [part];
  assert.deepEqual(later, [1, 1]);
  assert.deepEqual([...new Set(toasts())], ["at most 48 ports of 'arm' are recorded at a time"]);
  assert.deepEqual([47, 48].map((i) => part.channel(part.port(`Out ${i}`)!)), [47, -1]);
  view.show({ ...emptyPanel(), widgets: [data("scope", outputs(12, 60))] });
  assert.deepEqual(toasts(), []);
  view.show(emptyPanel());
  assert.ok(!part.isPlotted);
});

test("what a scope has recorded outlasts an edit of its panel", async () => {
  const { part, parts, goes } = await standing(0, 0, 0);
  const view = new PanelView({ ...emptyPanel(), widgets: [data("scope", ["Out 1"])] }, parts);
  goes(2, 0, 0, 0);
  view.add("label", []);
  assert.deepEqual(part.recordings()?.all([part.channel(part.port("Out 1")!)]), { times: [2], values: [[2]] });
});

test("a panel that is saved can be loaded, however full and far its widgets are", async () => {
  const { parts } = await standing(0, 0, 0);
  const view = new PanelView(emptyPanel(), parts);
  view.setEditing(true);
  for (let i = 0; i < 201; ++i) view.add("led", []);
  for (const shiftKey of [false, true])
    for (let i = 0; i < kMostRows + 1; ++i)
      happens(view.element.children[0]!, "keydown", { key: "ArrowDown", shiftKey });
  assert.deepEqual([view.panel.widgets[0]!.y, view.panel.widgets[0]!.h], [kMostRows, kMostRows]);
  assert.equal(parsePanel(formatPanel(view.panel)).widgets.length, 200);
  assert.deepEqual(toasts(), ["The panel is full: it has 200 widgets"]);
  view.show(emptyPanel());
  while (view.add("scope", []));
  assert.ok(parsePanel(formatPanel(view.panel)).widgets.length < 200);
});
