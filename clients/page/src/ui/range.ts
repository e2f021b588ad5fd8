// The range of a scale that fits its values. Pure.
import type { PortDescription } from "../link/messages";

export interface Range {
  low: number;
  high: number;
}

// A thousandth of what a port can be: less than that is noise, and a scale that fits by itself does not blow it up.
export function leastSpan({ minimum, maximum }: Pick<PortDescription, "minimum" | "maximum">): number {
  return Math.min(maximum - minimum, 10) / 1000;
}

// From the least to the greatest with `margin` (a share of the span) on both sides, `least` high at the least. NaN and
// null count for nothing; null: there is no number.
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
