// How a scenario fares. Pure.
import { ScenarioVerdict, type ScenarioState } from "../link/messages";
import type { Tone } from "../ui/tone";

// In words, and their colour.
export function verdictOf({ running, verdict, checks }: Pick<ScenarioState, "running" | "verdict" | "checks">): [string, Tone] {
  if (running) {
    const failed = checks.filter(({ passed }) => !passed).length;
    return failed > 0 ? [`runs, ${failed} failed`, "bad"] : ["runs", "busy"];
  }
  if (verdict === ScenarioVerdict.PASSED) return ["passed", "good"];
  return verdict === ScenarioVerdict.FAILED ? ["failed", "bad"] : ["invalid", "warn"];
}
