import assert from "node:assert/strict";
import { mock, test } from "node:test";
import type { RequestInit } from "../src/link/messages";
import { Clock } from "../src/model/clock";
import { server, settled } from "./server";

mock.method(globalThis, "setInterval", () => 0); // nothing is asked again and again

// A world that is asked to step and answers when `go` lets it; `end`: the tick beyond which it does not go.
function world(end = Infinity) {
  let tick = 0;
  const waiting: (() => void)[] = [];
  const { asked, cases, link } = server((request: RequestInit) => {
    if (request.case !== "step") return {};
    const { ticks } = request.value;
    return new Promise((resolve) => waiting.push(() => resolve({ tick: BigInt((tick = Math.min(end, tick + Number(ticks)))) })));
  });
  const steps = () => asked.flatMap((request) => (request.case === "step" ? [Number(request.value.ticks)] : []));
  const go = async () => {
    waiting.shift()?.();
    await settled();
  };
  return { clock: new Clock(link), steps, cases, go };
}

test("many ticks are asked for in pieces of 100 ms, each when the last is answered", async () => {
  const { clock, steps, go } = world();
  const done = clock.step(250);
  assert.deepEqual(steps(), [100]);
  assert.ok(clock.stepping.value);
  await go();
  assert.deepEqual(steps(), [100, 100]);
  await go();
  await go();
  await done;
  assert.deepEqual(steps(), [100, 100, 50]);
  assert.ok(!clock.stepping.value);
});

test("Pause ends a long step with its piece", async () => {
  const { clock, steps, cases, go } = world();
  const done = clock.step(1000);
  void clock.pause();
  assert.ok(!clock.stepping.value);
  await go();
  await done;
  assert.deepEqual(steps(), [100]);
  assert.deepEqual(cases().filter((name) => name !== "status"), ["step", "pause"]);
});

test("of short steps none is lost, however fast they are pressed", async () => {
  const { clock, steps, go } = world();
  const all = [clock.step(1), clock.step(1), clock.step(100)];
  for (const _ of all) await go();
  await Promise.all(all);
  assert.deepEqual(steps(), [1, 1, 100]);
});

test("another step takes the place of a long one, and a speed does not", async () => {
  const { clock, steps, go } = world();
  const long = clock.step(1000);
  void clock.setSpeed(0.5);
  await go();
  assert.deepEqual(steps(), [100, 100]);
  const short = clock.step(1);
  await go();
  await go();
  await Promise.all([long, short]);
  assert.deepEqual(steps(), [100, 100, 1]);
  assert.ok(!clock.stepping.value);
});

test("a step ends where time does", async () => {
  const { clock, steps, go } = world(150);
  const done = clock.step(100_000);
  for (let i = 0; i < 3; ++i) await go();
  await done;
  assert.deepEqual(steps(), [100, 100, 100]);
  assert.ok(!clock.stepping.value);
});
