// The page keeps layouts, leases and bookmarks between two loads.
import "./dom";
import assert from "node:assert/strict";
import { test } from "node:test";
import { parseLayout, type LayoutData } from "../src/layout/file";
import { leftBefore } from "../src/model/leaving";
import { freeBody } from "../src/world/bodies";
import { freeName } from "../src/world/bookmarks";

const layout: LayoutData = {
  visum_layout: 1, panes: { parts: true, panel: false, plots: true, log: false },
  plots: [{ ports: [{ part: "arm", port: "Actual Angle 1" }], seconds: 30 }],
  panel: { visum_panel: 1, name: "P", widgets: [] },
  camera: { position: [1, 2, 3], target: [0, 0, 0.5], fov: 40 },
};

test("a layout is read as it was written", () => assert.deepEqual(parseLayout(JSON.stringify(layout)), layout));

for (const [change, words] of [
  [{ visum_layout: 2 }, /visum_layout: must be 1/],
  [{ panes: 3 }, /panes: must be a map/],
  [{ plots: [{ ports: [{ part: 1 }], seconds: 5 }] }, /plots\[0\]\.ports\[0\]\.part: must be a text/],
  [{ plots: [{ ports: [], seconds: "x" }] }, /plots\[0\]\.seconds: must be a number/],
  [{ camera: { ...layout.camera, position: [1, 2] } }, /camera\.position: must be a number/],
] as const)
  test(`a layout is refused where it is bad: ${words.source}`, () => assert.throws(() => parseLayout(JSON.stringify({ ...layout, ...change })), words));

test("leases are taken up again after a reload, and not by a page that is opened later", () => {
  const left = JSON.stringify({ parts: ["arm", 7], atMs: 1000 });
  assert.deepEqual(leftBefore(left, 3000), ["arm"]);
  assert.deepEqual(leftBefore(left, 60_000), []);
  assert.deepEqual([null, "no JSON", "{}", '{"parts": 3, "atMs": 1}'].map((text) => leftBefore(text, 2)), [[], [], [], []]);
});

test("names that nobody has given are free", () => {
  assert.equal(freeName(["bookmark-1", "home"]), "bookmark-3");
  assert.equal(freeName(["bookmark-2"]), "bookmark-3");
  assert.deepEqual([freeBody([], "box"), freeBody(["box", "box_2"], "box")], ["box", "box_3"]);
});
