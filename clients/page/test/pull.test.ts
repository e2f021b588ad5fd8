import assert from "node:assert/strict";
import { test } from "node:test";
import { PushTimes, springPerKg } from "../src/view3d/pull";

const kTickNs = 1_000_000n;

test("a push lasts until the next one comes, at any speed", () => {
  const lasts = (factor: number) => new PushTimes().next(0n, kTickNs, factor);
  assert.deepEqual([1, 0.1, 10].map(lasts), [40_000_000n, 4_000_000n, 400_000_000n]);
  assert.deepEqual([0.001, 0].map(lasts), [kTickNs, kTickNs], "a tick at least");
});

test("while time stands, no second push waits beside the first", () => {
  const times = new PushTimes();
  assert.notEqual(times.next(5n, kTickNs, 1), null);
  assert.equal(times.next(5n, kTickNs, 1), null);
  assert.notEqual(times.next(6n, kTickNs, 1), null);
});

// The body as the pushes move it, which each see where it was when the one before began.
function swing(factor: number): number {
  const { stiffness, damping } = springPerKg(factor);
  const dt = 0.04 * factor;
  let [x, v, force] = [1, 0, 0];
  for (let i = 0; i < 1000; ++i) {
    const next = -stiffness * x - damping * v;
    v += dt * force;
    x += dt * v;
    force = next;
  }
  return Math.abs(x);
}

test("a pulled body comes to rest at any speed of the world", () => {
  for (const factor of [0.1, 0.5, 1, 2, 5, 10]) assert.ok(swing(factor) < 1e-3, `at ${factor}: ${swing(factor)}`);
});
