// An arm that falls behind what is commanded: whether the mover waits for it, and when it gives up.
import assert from "node:assert/strict";
import { test } from "node:test";
import type { Arm } from "../src/tool/arm";
import { Follower, type Behind } from "../src/tool/follower";

const kTickS = 0.04;

// One joint that is commanded at `speed`, and follows as `actual(time, commanded)` says.
function watched(seconds: number, speed: number, actual: (timeS: number, commanded: number) => number): Behind[] {
  let [timeS, value] = [0, 0];
  const arm = {
    part: { get sample() { return { simTimeNs: BigInt(Math.round(1e9 * timeS)) }; } },
    links: [{ joint: { name: "elbow", slides: false }, speed: undefined }],
    actual: () => [value],
  } as unknown as Arm;
  const follower = new Follower(arm);
  const seen: Behind[] = [];
  for (let i = 0; i * kTickS < seconds; ++i) {
    timeS = i * kTickS;
    const commanded = Math.min(speed * timeS, 1);
    value = actual(timeS, commanded);
    seen.push(follower.look([commanded]));
  }
  return seen;
}

test("an arm that follows with the delay of a ramp is not waited for, and arrives", () => {
  const seen = watched(4, 0.5, (timeS) => Math.min(0.5 * Math.max(0, timeS - 0.1), 1));
  assert.ok(seen.every(({ far, held }) => !far && held === ""));
  assert.deepEqual(seen.map(({ there }) => there).lastIndexOf(false) * kTickS > 2, true);
  assert.ok(seen.at(-1)!.there);
});

test("a joint that does not move is commanded no farther than a drive's following error", () => {
  const seen = watched(3, 0.3, () => 0);
  const farFrom = seen.findIndex(({ far }) => far);
  assert.ok(farFrom > 0 && 0.3 * farFrom * kTickS < 0.1, `${farFrom}`);
  assert.ok(seen.slice(farFrom).every(({ far }) => far));
});

test("a slow arm is waited for, and is not said to be held", () => {
  const seen = watched(10, 0.5, (timeS) => 0.01 * timeS);
  assert.ok(seen.at(-1)!.far);
  assert.ok(seen.every(({ held }) => held === ""));
});

test("an arm that stands away from where it should be is held, by name and distance", () => {
  const seen = watched(6, 0.1, (_, commanded) => Math.min(commanded, 0.05));
  assert.equal(seen[10]!.held, "");
  assert.match(seen.at(-1)!.held, /^elbow stays 31\.\d\d ° from where it is commanded; look for what holds it/);
});

test("what rests a little off is there", () => {
  assert.deepEqual(watched(6, 0.5, (_, commanded) => Math.min(commanded, 0.995)).at(-1), { far: false, there: true, held: "" });
});
