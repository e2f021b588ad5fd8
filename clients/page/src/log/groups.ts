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

export function groupOf(kind: string): string {
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
  return level >= filter.level && (filter.group === "" || groupOf(kind) === filter.group) && words.every((word) => all.includes(word));
}
