import assert from "node:assert/strict";
import { test } from "node:test";
import { Silence } from "../src/link/silence";

const looks = (silence: Silence, count: number, waiting = true) => Array.from({ length: count }, () => silence.look(waiting)).at(-1);

test("a server that leaves a question open for too many looks is silent", () => {
  const silence = new Silence(6);
  assert.equal(looks(silence, 6), false);
  assert.equal(silence.look(true), true);
});

test("a word in between begins the count anew", () => {
  const silence = new Silence(6);
  looks(silence, 6);
  silence.heard();
  assert.equal(looks(silence, 6), false);
});

test("who asks nothing does not wait", () => {
  assert.equal(looks(new Silence(6), 100, false), false);
});
