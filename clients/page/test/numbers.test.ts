import assert from "node:assert/strict";
import { test } from "node:test";
import { fieldText, formatBytes, formatInRange, formatNs, formatOf, formatTime, formatValue, inDegrees, inWords, niceStep, share } from "../src/ui/numbers";

test("values have as many digits as an eye can use", () => {
  assert.deepEqual([0, 1.23456, -12.3456, 123.456, 12345.67].map((value) => formatValue(value, "rad")), ["0.0000", "1.2346", "−12.346", "123.46", "12345.7"]);
  assert.deepEqual([formatValue(3), formatValue(NaN), formatValue(2.5e-6, "m"), formatValue(-1e9, "m")], ["3", "–", "2.50e−6", "−1.00e+9"]);
});

test("within a range the decimals stay, and nothing is minus zero", () => {
  assert.deepEqual([0, 1.23e-5, -1.23e-5, -12.3456].map((value) => formatInRange(value, -Math.PI, Math.PI, "rad")), ["0.0000", "0.0000", "0.0000", "−12.3456"]);
  assert.deepEqual([formatInRange(0.017, 0, 0.07, "m"), formatInRange(91.718, -180, 180, "°"), formatInRange(7, 0, 65535, "")], ["0.01700", "91.72", "7"]);
  assert.deepEqual([0.0000237, -0.0000237, 1.25, -0.5].map((value) => fieldText(value, 0, 12)), ["0", "0", "1.25", "-0.5"], "a field shows all of a number");
  assert.equal(fieldText(1234567.89, -Infinity, Infinity), "1234570");
  assert.deepEqual([formatInRange(2.5e-6, 0, Infinity, "m"), formatInRange(NaN, 0, 1, "m"), formatInRange(2e7, 0, 1, "m")], ["2.50e−6", "–", "2.00e+7"]);
});

test("time is minutes and seconds, and hours where there are some", () => {
  assert.deepEqual([0, 61.5, 3725.25, NaN].map(formatTime), ["00:00.000", "01:01.500", "1:02:05.250", "–"]);
});

test("nanoseconds and bytes in the unit that fits", () => {
  assert.deepEqual([12, 4500, 2.5e6, 3e9].map(formatNs), ["12 ns", "4.5 µs", "2.50 ms", "3.00 s"]);
  assert.deepEqual([999, 1500, 2.5e6].map(formatBytes), ["999 B", "1.5 kB", "2.50 MB"]);
});

test("radians are told in degrees, too", () => {
  assert.equal(inDegrees(Math.PI, "rad"), "180.00 °");
  assert.equal(inDegrees(Math.PI, "rad/s"), "180.00 °/s");
  assert.equal(inDegrees(1, "m"), "");
});

test("a share stays within its limits, and a range of nothing has none", () => {
  assert.deepEqual([share(5, 0, 10), share(-1, 0, 10), share(11, 0, 10), share(1, 1, 1)], [0.5, 0, 1, 0]);
});

test("steps of editors are 1, 2 or 5 times a power of ten", () => {
  assert.deepEqual([niceStep(0, 1), niceStep(-1, 1), niceStep(0, 4), niceStep(0, 0)], [0.001, 0.002, 0.005, 1]);
});

test("a port with names shows words", () => {
  const state = { minimum: 0, maximum: 4294967295, unit: "", bits: [{ number: 1n, name: "HOME_OK" }, { number: 15n, name: "RAMP_END" }] };
  assert.equal(formatOf(state, 32770), "HOME_OK RAMP_END");
  assert.equal(formatOf(state, 0), "0");
  assert.equal(inWords({ values: [{ number: 1n, name: "moving" }] }, 1), "moving");
  assert.deepEqual([inWords(state, NaN), inWords(state, 0.5), inWords(state, -1), inWords({}, 3)], ["", "", "", ""]);
});
