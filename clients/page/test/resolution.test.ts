import assert from "node:assert/strict";
import { test } from "node:test";
import { Resolution } from "../src/view3d/resolution";

// A world that moves, on a display that needs `ms` for a picture.
function run(resolution: Resolution, from: number, pictures: number, ms: number): { now: number; share: number } {
  let share = NaN;
  for (let i = 0; i < pictures; ++i) share = resolution.frame(from + i * ms, true)!;
  return { now: from + (pictures - 1) * ms, share };
}

test("a quick machine draws every pixel", () => {
  assert.equal(run(new Resolution(), 0, 500, 16).share, 1);
});

test("a slow one draws fewer, but never too few to see", () => {
  assert.ok(run(new Resolution(), 0, 3, 80).share < 0.6);
  assert.equal(run(new Resolution(), 0, 100, 1000).share, 0.4);
});

test("when the world stands, it is drawn once with every pixel", () => {
  const resolution = new Resolution();
  const { now } = run(resolution, 0, 20, 200);
  assert.equal(resolution.frame(now + 16, false), null);
  assert.equal(resolution.frame(now + 1500, false), null, "it rests between two movements");
  assert.equal(resolution.frame(now + 2100, false), 1);
  assert.equal(resolution.frame(now + 4000, false), null);
});

test("a machine that is free again gets its pixels back", () => {
  const resolution = new Resolution();
  const { now } = run(resolution, 0, 20, 200);
  assert.equal(run(resolution, now + 16, 400, 16).share, 1);
});

test("a pause between two movements is no slowness", () => {
  const resolution = new Resolution();
  for (let now = 0; now < 60_000; now += 3000) {
    assert.equal(resolution.frame(now, true), 1);
    assert.equal(resolution.frame(now + 16, false), null);
  }
});

test("pixels that prove too many are tried ever more seldom", () => {
  const resolution = new Resolution();
  // A machine that is quick with few pixels, and slow with many
  let [now, share, changes] = [0, 1, 0];
  for (let i = 0; i < 5000; ++i) {
    const next = resolution.frame((now += share > 0.6 ? 80 : 16), true)!;
    if (next !== share) ++changes;
    share = next;
  }
  assert.ok(changes > 3 && changes < 20, `${changes} changes of the canvas`);
});
