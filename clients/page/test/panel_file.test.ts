import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { test } from "node:test";
import { BadFileError } from "../src/common/checked";
import { formatPanel, freePlace, kColumns, parsePanel } from "../src/panels/file";
import { fromHash, toHash } from "../src/ui/link_text";

const kPrefix = "#panel=";
const kSlider = { type: "slider", label: "Joint 1", x: 0, y: 0, w: 12, h: 2, ports: [{ part: "arm", port: "Desired Angle 1" }], jog: 0.05 };
const panel = (change: object = {}) => JSON.stringify({ visum_panel: 1, name: "P", widgets: [{ ...kSlider, ...change }] });
const complaint = (text: string) => {
  try {
    parsePanel(text);
  } catch (error) {
    assert.ok(error instanceof BadFileError);
    return error.message;
  }
  assert.fail("nothing was refused");
};

test("what is written is read again", () => {
  const data = parsePanel(panel());
  assert.deepEqual(parsePanel(formatPanel(data)), data);
  assert.deepEqual(data.widgets[0], kSlider);
});

for (const [change, words] of [
  [{ type: "lever" }, /widgets\[0\]\.type: must be one of slider, .*is 'lever'/],
  [{ x: 3 }, /widgets\[0\]: reaches beyond the 12 columns/],
  [{ w: 0 }, /widgets\[0\]\.w: must be a whole number from 1 to 12/],
  [{ y: 1.5 }, /widgets\[0\]\.y: must be a whole number/],
  [{ ports: [{ part: "arm" }] }, /widgets\[0\]\.ports\[0\]\.port: must be a text/],
  [{ minimum: "low" }, /widgets\[0\]\.minimum: must be a number/],
  [{ choices: [{ label: "a", value: 1 }, 3] }, /widgets\[0\]\.choices\[1\]: must be a map/],
  [{ mode: "toggle" }, /widgets\[0\]\.mode: must be counter or value/],
] as const)
  test(`a bad panel is refused where it is bad: ${JSON.stringify(change)}`, () => assert.match(complaint(panel(change)), words));

test("a widget has no more ports than can be recorded", () =>
  assert.match(complaint(panel({ ports: Array(49).fill(kSlider.ports[0]) })), /widgets\[0\]\.ports: more than 48/));

test("a file that is not a panel is refused", () => {
  assert.match(complaint("{"), /the file is not JSON/);
  assert.match(complaint("[]"), /the file: must be a map/);
  assert.match(complaint('{"visum_panel": 2}'), /visum_panel: must be 1/);
  assert.match(complaint(JSON.stringify({ visum_panel: 1, name: "", widgets: Array(201).fill(kSlider) })), /more than 200/);
});

test("panels that scenes ship are good", () => {
  const folder = "../../models/panels"; // of clients/page, where the tests run
  const files = readdirSync(folder).filter((name) => name.endsWith(".json"));
  assert.ok(files.length > 0);
  for (const file of files) parsePanel(readFileSync(`${folder}/${file}`, "utf8"));
});

test("a new widget takes the first free place", () => {
  const at = (x: number, y: number, w: number) => ({ ...parsePanel(panel()).widgets[0]!, x, y, w, h: 2 });
  assert.deepEqual(freePlace([], kColumns, 2), { x: 0, y: 0 });
  assert.deepEqual(freePlace([at(0, 0, 6)], 6, 2), { x: 6, y: 0 });
  assert.deepEqual(freePlace([at(0, 0, 6), at(6, 0, 6)], 1, 1), { x: 0, y: 2 });
});

test("a panel goes into a link and comes out of it", async () => {
  const text = formatPanel(parsePanel(panel({ label: "Gelenk ä 🦾" })));
  const hash = await toHash(kPrefix, text);
  assert.match(hash, /^#panel=[A-Za-z0-9_-]+$/);
  assert.equal(await fromHash(kPrefix, hash), text);
  assert.equal(await fromHash(kPrefix, "#elsewhere"), null);
  await assert.rejects(fromHash(kPrefix, "#panel=AAAA"));
});

test("a link cannot fill the memory", async () => {
  const bomb = await toHash(kPrefix, "0".repeat(3 << 20));
  assert.ok(bomb.length < 10_000);
  await assert.rejects(fromHash(kPrefix, bomb), /too large/);
});
