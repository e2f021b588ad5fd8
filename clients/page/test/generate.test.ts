import assert from "node:assert/strict";
import { test } from "node:test";
import type { PartDescription } from "../src/link/messages";
import { softLimits } from "../src/model/soft_limits";
import { formatPanel, parsePanel } from "../src/panels/file";
import { generatedPanel } from "../src/panels/generate";
import { gapsOf } from "../src/plots/gaps";
import { distanceToSee } from "../src/view3d/framing";

const port = (name: string, group: string, unit: string, minimum: number, maximum: number, values: { number: bigint; name: string }[] = []) =>
  ({ name, group, unit, minimum, maximum, initial: 0, values, bits: [] });
const limit = (name: string, unit: string, value: number) => ({ name, unit, help: "", value: { value: { case: "number", value } }, choices: [], readOnly: false });
const arm = {
  name: "arm",
  controllerInputs: [
    port("Desired Angle 1", "Desired Angle", "rad", -9, 9), port("Desired Angle 2", "Desired Angle", "rad", -9, 9),
    port("Maximum Speed 1", "Maximum Speed", "rad/s", 0, 1),
    port("Desired Finger Position 1", "Desired Finger Position", "m", 0, 0.1), port("Desired Finger Position 2", "Desired Finger Position", "m", 0, 0.1),
    port("Reset", "Reset", "", 0, 1e6), port("Execution Enable", "Execution Enable", "", 0, 1),
  ],
  sensorOutputs: [port("Actual Angle 1", "Actual Angle", "rad", -9, 9), port("Part State", "Part State", "", 0, 7, [{ number: 0n, name: "ready" }])],
  parameters: [["rad", 3.1, 1], ["rad", 2.2, 2], ["m", 0.07, 3]].flatMap(([unit, most, number]) =>
    [limit(`Soft Limit Minimum ${number}`, String(unit), unit === "m" ? 0 : -Number(most)), limit(`Soft Limit Maximum ${number}`, String(unit), Number(most))]),
} as unknown as PartDescription;

test("soft limits belong to the inputs of their drives, and are shared by what one drive moves", () => {
  assert.deepEqual([...softLimits(arm)], [
    ["Desired Angle 1", { minimum: -3.1, maximum: 3.1 }], ["Desired Angle 2", { minimum: -2.2, maximum: 2.2 }],
    ["Desired Finger Position 1", { minimum: 0, maximum: 0.035 }], ["Desired Finger Position 2", { minimum: 0, maximum: 0.035 }],
  ]);
});

test("no limit is guessed where drives and inputs do not agree in number", () => {
  const inputs = [...arm.controllerInputs, port("Desired Angle 3", "Desired Angle", "rad", -9, 9)] as PartDescription["controllerInputs"];
  assert.ok(!softLimits({ ...arm, controllerInputs: inputs }).has("Desired Angle 1"));
});

test("a panel is made of what commands a part and tells its state, and can be loaded again", () => {
  const panel = generatedPanel([arm]);
  assert.deepEqual(panel.widgets.map(({ type, label }) => `${type} ${label}`), [
    "label arm", "slider Desired Angle 1", "slider Desired Angle 2", "slider Desired Finger Position 1", "slider Desired Finger Position 2",
    "button Reset", "radio Execution Enable", "lcd Part State",
  ]);
  assert.deepEqual(panel.widgets[1]!.actual, { part: "arm", port: "Actual Angle 1" });
  assert.deepEqual(parsePanel(formatPanel(panel)), panel);
});

test("widgets of a generated panel do not overlap", () => {
  const taken = new Set<string>();
  for (const { x, y, w, h, label } of generatedPanel([arm, { ...arm, name: "other" }]).widgets)
    for (let i = x; i < x + w; ++i)
      for (let j = y; j < y + h; ++j) {
        assert.ok(!taken.has(`${i},${j}`), `${label} at ${i}, ${j}`);
        taken.add(`${i},${j}`);
      }
});

test("a gap lies between the samples on both sides of it", () => {
  assert.deepEqual(gapsOf([0, 1, 1.5, 2, 3], [[5, 5, null, 6, 6]]), [{ from: 1, to: 2 }]);
  assert.deepEqual(gapsOf([0, 1, 1.5, 2, 3], [[5, 5, null, 6, 6], [1, undefined, undefined, undefined, 1]]), [{ from: 1, to: 2 }]);
  assert.deepEqual(gapsOf([0, 1, 2], [[5, null, 6], [5, 5, 6]]), [], "the other trace has a sample");
  assert.deepEqual(gapsOf([0, 1, 2, 3, 4], [[null, null, 5, 5, 5]]), [], "nobody asked for it before");
});

// A ray at the angle of view touches the sphere: the closed form.
test("the camera is as far away as the narrower angle of view needs", () => {
  const least = (angle: number) => 1 / Math.sin(angle / 2);
  const vertical = (40 * Math.PI) / 180;
  assert.ok(distanceToSee(1, 40, 2) >= least(vertical) && distanceToSee(1, 40, 2) < 1.1 * least(vertical));
  const narrow = 2 * Math.atan(0.5 * Math.tan(vertical / 2));
  assert.ok(distanceToSee(1, 40, 0.5) >= least(narrow) && distanceToSee(1, 40, 0.5) < 1.1 * least(narrow));
});
