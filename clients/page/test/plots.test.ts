import assert from "node:assert/strict";
import { test } from "node:test";
import { toCsv } from "../src/plots/csv";
import { align } from "../src/plots/merge";
import { polyline } from "../src/ui/polyline";
import { fit, leastSpan } from "../src/ui/range";

test("a scale fits its values with some air", () => {
  assert.deepEqual(fit([1, 3, null, NaN, 2], 0.25, 0), { low: 0.5, high: 3.5 });
});

test("noise below a thousandth of the range is not blown up", () => {
  const least = leastSpan({ minimum: -2.5, maximum: 2.5 });
  assert.equal(least, 0.005);
  const range = fit([0.1, 0.1002], 0.08, least)!;
  assert.ok(Math.abs(range.high - range.low - least) < 1e-12);
  assert.ok(Math.abs((range.low + range.high) / 2 - 0.1001) < 1e-12);
});

test("nothing has no scale; one value alone has one", () => {
  assert.equal(fit([], 0.1, 1), null);
  assert.equal(fit([null, NaN], 0.1, 1), null);
  assert.deepEqual(fit([3], 0.1, 0), { low: 2.5, high: 3.5 });
});

test("CSV has a row for each time of any column, and quotes what must be", () => {
  const text = toCsv([
    { name: "arm a [rad]", times: [0, 0.001], values: [1.5, null] },
    { name: 'b, "c"', times: [0.001, 0.002], values: [-2, 1e-7] },
  ]);
  assert.deepEqual(text.split("\r\n"), ['time [s],arm a [rad],"b, ""c"""', "0,1.5,", "0.001,,-2", "0.002,,1e-7", ""]);
});

test("series of two parts stand on one time axis", () => {
  const aligned = align([
    { times: [0, 2], values: [[1, 2]] },
    { times: [1, 2], values: [[3, 4], [null, 6]] },
  ]);
  // Undefined: the trace goes on. Null: it has a gap.
  assert.deepEqual(aligned, [[0, 1, 2], [1, undefined, 2], [undefined, 3, 4], [undefined, null, 6]]);
});

test("a line is broken at a gap, and goes on where only another trace has a sample", () => {
  const seen: string[] = [];
  const path = { moveTo: (x: number) => void seen.push(`to ${x}`), lineTo: (x: number) => void seen.push(`line ${x}`) };
  polyline(path, [null, [1, 0], undefined, [2, 0], null, [3, 0], [4, 0]]);
  assert.deepEqual(seen, ["to 1", "line 2", "to 3", "line 4"]);
});
