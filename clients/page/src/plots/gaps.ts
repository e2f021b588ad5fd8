// Shades the times of a plot for which this page has no samples: it was too busy to take them, or not
// connected. The line goes on over them, because the world went on, too.
import type uPlot from "uplot";
import { cssColor } from "../ui/palette";

const kLeastPixels = 2;

// A hook of uPlot, before it draws its lines.
export function shadeGaps(plot: uPlot): void {
  const gaps = gapsOf(plot.data[0] as number[], plot.data.slice(1));
  if (gaps.length === 0) return;
  const { left, top, width, height } = plot.bbox;
  const { ctx } = plot;
  ctx.save();
  ctx.fillStyle = cssColor("--gap");
  for (const { from, to } of gaps) {
    const [a, b] = [from, to].map((time) => Math.min(left + width, Math.max(left, plot.valToPos(time, "x", true)))) as [number, number];
    if (b > left && a < left + width) ctx.fillRect(a, top, Math.max(kLeastPixels, b - a), height);
  }
  ctx.restore();
}

// The times between the samples on both sides of each null. Before its first value a plot was not there yet.
// Pure.
export function gapsOf(times: ArrayLike<number>, traces: readonly ArrayLike<number | null | undefined>[]): { from: number; to: number }[] {
  const gaps: { from: number; to: number }[] = [];
  for (let i = firstValue(times.length, traces) + 1; i + 1 < times.length; ++i) {
    if (!isGap(traces, i)) continue;
    const last = gaps.at(-1);
    if (last && last.to === times[i]) last.to = times[i + 1]!;
    else gaps.push({ from: times[i - 1]!, to: times[i + 1]! });
  }
  return gaps;
}

function firstValue(length: number, traces: readonly ArrayLike<number | null | undefined>[]): number {
  for (let i = 0; i < length; ++i) if (traces.some((trace) => typeof trace[i] === "number")) return i;
  return length;
}

// A null, and no value. Undefined: only another part has a sample at that time.
function isGap(traces: readonly ArrayLike<number | null | undefined>[], i: number): boolean {
  let gap = false;
  for (const trace of traces) {
    const value = trace[i];
    if (value === null) gap = true;
    else if (value !== undefined) return false;
  }
  return gap;
}
