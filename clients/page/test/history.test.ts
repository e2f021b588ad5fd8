import assert from "node:assert/strict";
import { test } from "node:test";
import { History, kBlock } from "../src/model/history";

const kMs = 0.001;
// A sine with one sample that stands out: thinning must not lose it.
const kSpike = 7777;
const wave = (n: number) => (n === kSpike ? 9 : Math.sin(n / 500));

function filled(count: number, capacity: number): History {
  const history = new History(2, capacity);
  for (let n = 0; n < count; ++n) history.add(n * kMs, (channel) => (channel === 0 ? wave(n) : n));
  return history;
}

test("a short window has every sample", () => {
  const { times, values } = filled(1000, 4096).window(0.1, 0.2, 500, [1]);
  assert.equal(times.length, 101);
  assert.deepEqual([values[0]!.at(0), values[0]!.at(-1)], [100, 200]);
});

test("a long window is thinned to about as many points as asked for, and keeps every peak", () => {
  for (const most of [50, 200, 800]) {
    const { times, values } = filled(20_000, 32_768).window(0, 20, most, [0]);
    assert.ok(times.length <= most + 2, `${times.length} points of ${most}`);
    assert.equal(Math.max(...values[0]!.map(Number)), 9);
    const others = values[0]!.map(Number).filter((value) => value !== 9);
    assert.ok(Math.min(...others) < -0.999 && Math.max(...others) > 0.999);
    assert.deepEqual(times, [...times].sort((a, b) => a - b));
  }
});

test("the oldest samples fall out, and blocks that were written over tell of the new ones only", () => {
  const history = new History(1, 4 * kBlock);
  for (let n = 0; n < 4 * kBlock; ++n) history.add(n * kMs, () => 1000);
  for (let n = 4 * kBlock; n < 8 * kBlock; ++n) history.add(n * kMs, () => 1);
  assert.equal(history.length, history.capacity);
  assert.equal(history.firstTime, 4 * kBlock * kMs);
  const { values } = history.window(0, 1, 2, [0]);
  assert.deepEqual([...new Set(values[0])], [1]);
});

test("a sample that comes late is there already", () => {
  const history = filled(2, 1024);
  history.add(0, () => 5);
  history.add(kMs, () => 6);
  assert.deepEqual(history.all([0]), filled(2, 1024).all([0]));
});

test("what was not recorded is nothing", () => {
  const history = new History(1, 64);
  history.add(0, () => NaN);
  history.add(1, () => 2);
  assert.deepEqual(history.all([0]).values, [[null, 2]]);
});

// A ramp of 1 ms samples that lost what lies between `from` and `to`.
function torn(count: number, from: number, to: number): History {
  const history = new History(1, 32_768);
  for (let n = 0; n < count; ++n) if (n <= from || n >= to) history.add(n * kMs, () => n, n === to);
  return history;
}

test("samples that were lost are a gap in a short window, and in an export they are not there", () => {
  const history = torn(200, 100, 150);
  const { times, values } = history.window(0.099, 0.151, 500, [0]);
  assert.deepEqual(values[0], [99, 100, null, 150, 151]);
  assert.ok(Math.abs(times[2]! - 0.125) < 1e-12);
  assert.equal(history.all([0]).values[0]!.includes(null), false);
});

test("a gap is seen in a long window, wherever it lies among the groups, and costs no peak", () => {
  for (const [from, to] of [[5000, 6000], [5119, 5120 + 64], [5120, 9999]] as const) {
    const { times, values } = torn(20_000, from, to).window(0, 20, 100, [0]);
    const at = values[0]!.indexOf(null);
    assert.equal(values[0]!.lastIndexOf(null), at, "one gap");
    assert.ok(times[at]! > from * kMs && times[at]! < to * kMs);
    assert.equal(values[0]![at - 1], from);
    assert.equal(values[0]![at + 1], to);
    assert.deepEqual([values[0]!.at(0), values[0]!.at(-1)], [0, 19_999]);
    assert.deepEqual(times, [...times].sort((a, b) => a - b));
  }
});

test("many gaps within a pixel do not make more points than two for each group", () => {
  const history = new History(1, 32_768);
  for (let n = 0; n < 20_000; ++n) history.add(n * kMs, () => n, n % 3 === 0);
  assert.ok(history.window(0, 20, 100, [0]).times.length <= 3 * 102);
});

test("a history that gets a channel more keeps its samples and its gaps", () => {
  const wide = torn(200, 100, 150).widened(2);
  const { values } = wide.window(0.1, 0.15, 500, [0, 1]);
  assert.deepEqual(values, [[100, null, 150], [null, null, null]]);
});
