// The range of a scale that fits its values. Pure.
import type { PortDescription } from "../link/messages";

export interface Range {
  low: number;
  high: number;
}

// A thousandth of a port's range. Smaller changes are noise, and a scale that fits itself must not blow them
// up.
export function leastSpan({ minimum, maximum }: Pick<PortDescription, "minimum" | "maximum">): number {
  return Math.min(maximum - minimum, 10) / 1000;
}

// The scale from the least to the greatest value, with `margin` (a share of the span) on both sides, and at
// least `least` high. NaN and null are ignored. Returns null if there is no number.
export function fit(values: Iterable<number | null>, margin: number, least: number): Range | null {
  let low = Infinity;
  let high = -Infinity;
  for (const value of values) {
    if (value === null || Number.isNaN(value)) continue;
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  if (low > high) return null;
  const middle = (low + high) / 2;
  const reach = Math.max((0.5 + margin) * (high - low), least / 2) || 0.5;
  return { low: middle - reach, high: middle + reach };
}
