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

test("time that goes back begins anew; the same time twice counts once", () => {
  const history = filled(100, 1024);
  history.add(0.05, () => 5);
  history.add(0.05, () => 6);
  assert.deepEqual(history.all([0]), { times: [0.05], values: [[Math.fround(5)]] });
});

test("what was not recorded is nothing", () => {
  const history = new History(1, 64);
  history.add(0, () => NaN);
  history.add(1, () => 2);
  assert.deepEqual(history.all([0]).values, [[null, 2]]);
});
