import assert from "node:assert/strict";
import { test } from "node:test";
import { ScenarioVerdict, type ScenarioState } from "../src/link/messages";
import { verdictOf } from "../src/world/verdict";

const check = (passed: boolean) => ({ name: "a", passed, text: "" }) as ScenarioState["checks"][number];

test("the verdict of a scenario is a word and a colour, and a failed check is told while it runs", () => {
  const at = (running: boolean, verdict: ScenarioVerdict, ...passed: boolean[]) => verdictOf({ running, verdict, checks: passed.map(check) });
  assert.deepEqual(at(true, ScenarioVerdict.UNSPECIFIED, true), ["runs", "busy"]);
  assert.deepEqual(at(true, ScenarioVerdict.UNSPECIFIED, true, false), ["runs, 1 failed", "bad"]);
  assert.deepEqual(at(false, ScenarioVerdict.PASSED, true), ["passed", "good"]);
  assert.deepEqual(at(false, ScenarioVerdict.FAILED, false), ["failed", "bad"]);
  assert.deepEqual(at(false, ScenarioVerdict.INVALID), ["invalid", "warn"]);
});
