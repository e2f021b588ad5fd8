// Shades the times of a plot for which this page has no samples: it was too busy to take them, or not
// connected. The line goes on over them, because the world went on, too.
import type uPlot from "uplot";
import { cssColor } from "../ui/palette";

const kLeastPixels = 2;

// A hook of uPlot, before it draws its lines.
export function shadeGaps(plot: uPlot): void {
  const { left, top, width, height } = plot.bbox;
  const { ctx } = plot;
  ctx.save();
  ctx.fillStyle = cssColor("--gap");
  for (const { from, to } of gapsOf(plot.data[0] as number[], plot.data.slice(1))) {
    const [a, b] = [from, to].map((time) => Math.min(left + width, Math.max(left, plot.valToPos(time, "x", true)))) as [number, number];
    if (b > left && a < left + width) ctx.fillRect(a, top, Math.max(kLeastPixels, b - a), height);
  }
  ctx.restore();
}

// The times between the samples on both sides of each null. Pure.
export function gapsOf(times: ArrayLike<number>, traces: readonly ArrayLike<number | null | undefined>[]): { from: number; to: number }[] {
  const gaps: { from: number; to: number }[] = [];
  for (let i = 0; i < times.length; ++i) {
    if (i === 0 || i + 1 >= times.length || !isGap(traces.map((trace) => trace[i]))) continue;
    const last = gaps.at(-1);
    if (last && last.to === times[i]) last.to = times[i + 1]!;
    else gaps.push({ from: times[i - 1]!, to: times[i + 1]! });
  }
  return gaps;
}

// Undefined: only another part has a sample at that time.
function isGap(values: readonly (number | null | undefined)[]): boolean {
  return values.includes(null) && values.every((value) => value === null || value === undefined);
}
