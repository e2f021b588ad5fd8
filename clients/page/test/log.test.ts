import assert from "node:assert/strict";
import { test } from "node:test";
import { kGroupNames, groupOf, matches } from "../src/log/groups";

const event = { kind: "fault", text: "gear_slip 3", source: "arm", level: 3 };

test("an event matches where its group, its level and all words do", () => {
  const all = { words: "", group: "", level: 2 };
  assert.ok(matches(event, all));
  assert.ok(matches(event, { ...all, words: "ARM slip" }));
  assert.ok(!matches(event, { ...all, words: "arm leg" }));
  assert.ok(matches(event, { ...all, group: "faults" }) && !matches(event, { ...all, group: "time" }));
  assert.ok(matches(event, { ...all, level: 3 }) && !matches(event, { ...all, level: 4 }));
});

test("a kind that this page does not know is in a group, too", () => {
  assert.equal(groupOf("from_a_later_server"), "other");
  assert.equal(groupOf("log", "'arm' has tripped: joint_2: following error 0.31 rad exceeds 0.3 rad"), "faults");
  assert.equal(groupOf("log", "something else"), "lines");
  assert.ok(kGroupNames.includes("other"));
});
