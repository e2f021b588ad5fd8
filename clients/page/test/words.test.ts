import "./dom";
import assert from "node:assert/strict";
import { test } from "node:test";
import { splitReason } from "../src/bar/frozen";
import { whoElse } from "../src/bar/reset";
import { reasonOf } from "../src/bar/part_state";
import { toneOf } from "../src/ui/tone";

test("each state of a part has the urgency of its words", () => {
  const tones = ["ready", "moving", "homing", "disabled", "not homed", "halted", "fault", "controller lost", ""].map(toneOf);
  assert.deepEqual(tones, ["good", "busy", "busy", "warn", "warn", "warn", "bad", "bad", "plain"]);
});

test("of a module's bits the worst one counts", () => {
  assert.equal(toneOf("HOME_OK BRAKEACTIVE"), "good");
  assert.equal(toneOf("HOME_OK MOTION RAMP_STEADY"), "busy");
  assert.equal(toneOf("ERROR HOME_OK TOW_ERROR"), "bad");
  assert.equal(toneOf("HOME_OK BEYOND_SOFT"), "bad");
  assert.equal(toneOf("HOME_OK POW_VOLT_ERR"), "bad");
});

test("a fault tells its own reason, and without one the way out", () => {
  assert.equal(reasonOf("fault", "joint_2: following error 0.31 rad, limit 0.30\njoint_3: x\n"), "joint_2: following error 0.31 rad, limit 0.30; joint_3: x");
  assert.equal(reasonOf("fault", ""), "press Reset");
  assert.equal(reasonOf("ready", ""), "");
});

test("a freeze is split into its reason and the file of the ticks before it", () => {
  assert.deepEqual(splitReason("body 'box' is lost; the ticks before it are in /tmp/a.mcap"), { reason: "body 'box' is lost", file: "/tmp/a.mcap" });
  assert.deepEqual(splitReason("body 'box' is lost"), { reason: "body 'box' is lost", file: "" });
});

test("a reset names those whom it concerns, and nobody where there is nobody", () => {
  assert.equal(whoElse("me", ["me", "", ""], 1), "");
  assert.equal(whoElse("me", ["me", "a", "a", "b"], 4), "'a', 'b' command a part of it.");
  assert.equal(whoElse("me", ["a"], 2), "'a' commands a part of it.");
  assert.equal(whoElse("me", [""], 2), "Another session is connected.");
  assert.equal(whoElse("me", [""], 4), "3 other sessions are connected.");
});
