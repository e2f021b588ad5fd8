// Events by what a user looks for, and which of them match a filter. Pure.
import type { Happening } from "../model/events";

const kGroups = {
  faults: ["fault", "fault_cleared", "emergency_stop", "frozen", "fault_refused", "push_refused"],
  control: ["lease_granted", "lease_released", "lease_lost", "lockstep_timeout", "parameter"],
  time: ["pause", "resume", "reset", "era", "snapshot", "restore", "recording", "world_changed", "load"],
  lines: ["line", "log"],
  checks: ["check", "scenario"],
} as const;
export const kGroupNames = [...Object.keys(kGroups), "other"];

// A drive that trips says so in the server's log (server/gateway/tick_side.cc).
const kTripped = /^'.*' has tripped: /;

export function groupOf(kind: string, text = ""): string {
  if (kind === "log" && kTripped.test(text)) return "faults";
  return Object.entries(kGroups).find(([, kinds]) => (kinds as readonly string[]).includes(kind))?.[0] ?? "other";
}

export interface Filter {
  words: string; // all of them must be in it
  group: string; // empty: any
  level: number; // the least
}

export function matches({ kind, text, source, level }: Pick<Happening, "kind" | "text" | "source" | "level">, filter: Filter): boolean {
  const all = `${kind} ${source} ${text}`.toLowerCase();
  const words = filter.words.toLowerCase().split(/\s+/).filter(Boolean);
  return level >= filter.level && (filter.group === "" || groupOf(kind, text) === filter.group) && words.every((word) => all.includes(word));
}
