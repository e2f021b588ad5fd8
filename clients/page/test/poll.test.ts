import assert from "node:assert/strict";
import { mock, test } from "node:test";
import { poll } from "../src/model/poll";
import { settled } from "./server";

// The timers of a poll, by hand.
function timers() {
  const running = new Map<number, () => void>();
  let next = 1;
  mock.method(globalThis, "setInterval", (call: () => void) => (running.set(next, call), next++));
  mock.method(globalThis, "clearInterval", (timer: number) => running.delete(timer));
  return { running, tick: () => running.forEach((call) => call()) };
}

test("asks again when the last answer is there, and not before", async () => {
  const { tick } = timers();
  const answers: (() => void)[] = [];
  poll(() => new Promise((resolve) => answers.push(resolve)), 100);
  for (let i = 0; i < 5; ++i) tick();
  assert.equal(answers.length, 1);
  answers[0]!();
  await settled();
  tick();
  assert.equal(answers.length, 2);
});

test("ends where it is ended", () => {
  const { running, tick } = timers();
  let asked = 0;
  const stop = poll(async () => void (asked += 1), 100);
  stop();
  tick();
  assert.deepEqual([asked, running.size], [0, 0]);
});
