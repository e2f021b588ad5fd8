import assert from "node:assert/strict";
import { test } from "node:test";
import { Playhead } from "../src/model/playhead";
import { between, PoseBuffer } from "../src/model/poses";

const near = (a: number, b: number, tolerance = 1e-12) => assert.ok(Math.abs(a - b) <= tolerance, `${a} is not ${b}`);
const aboutZ = (angle: number, x = 0) => [x, 0, 0, Math.cos(angle / 2), 0, 0, Math.sin(angle / 2)];

test("half way between two poses is half of the way and half of the turn", () => {
  const out = new Float64Array(7);
  between(aboutZ(0.2, 1), aboutZ(0.6, 3), 0.5, out);
  near(out[0]!, 2);
  near(2 * Math.atan2(out[6]!, out[3]!), 0.4);
  near(Math.hypot(out[3]!, out[4]!, out[5]!, out[6]!), 1);
});

test("q and -q are one orientation: no turn the long way round", () => {
  const out = new Float64Array(7);
  between(aboutZ(0.2), aboutZ(0.2).map((value, i) => (i >= 3 ? -value : value)), 0.5, out);
  near(2 * Math.atan2(out[6]!, out[3]!), 0.2);
});

test("between samples is interpolated by simulated time, beyond them the nearest is shown", () => {
  const buffer = new PoseBuffer();
  const out = new Float64Array(7);
  assert.equal(buffer.at(0, out), false);
  buffer.add(10, aboutZ(0, 0));
  buffer.add(20, aboutZ(0, 1));
  buffer.at(12.5, out);
  near(out[0]!, 0.25);
  buffer.at(-5, out);
  near(out[0]!, 0);
});

test("shown time runs evenly where samples come unevenly, and never back", () => {
  const playhead = new Playhead(40);
  let shown = -Infinity;
  const steps: number[] = [];
  for (let wall = 0; wall < 2000; wall += 4) {
    if (wall % 16 === 0) playhead.heard(wall, wall + (wall % 48 === 0 ? 6 : 0)); // a third of them is late
    const now = playhead.at(wall + 8);
    assert.ok(now >= shown);
    if (wall > 1000) steps.push(now - shown);
    shown = now;
  }
  assert.ok(Math.max(...steps) < 12 && shown > 1900, `${Math.max(...steps)} ${shown}`);
});

test("when samples stop, what is known is shown to its end and no further", () => {
  const playhead = new Playhead(40);
  for (let t = 0; t <= 500; t += 16) playhead.heard(t, t);
  assert.equal(playhead.at(2000), 496);
});

test("a reset shows the new beginning at once", () => {
  const playhead = new Playhead(40);
  for (let t = 0; t <= 500; t += 16) playhead.heard(t, t);
  playhead.heard(0, 520);
  assert.ok(playhead.at(521) <= 0);
});
