// Puts series of several parts on one time axis, as uPlot wants them: all times, and for each trace a value
// at each time. A value is null in a gap, and undefined if only another part has a sample. Pure.
import type { Series } from "../model/history";

export type Aligned = [number[], ...(number | null | undefined)[][]];

export function align(series: readonly Series[]): Aligned {
  if (series.length === 1) return [series[0]!.times, ...series[0]!.values];
  const times = [...new Set(series.flatMap((one) => one.times))].sort((a, b) => a - b);
  const traces = series.flatMap((one) => {
    const index = new Map(one.times.map((time, i) => [time, i]));
    return one.values.map((values) => times.map((time) => {
      const i = index.get(time);
      return i === undefined ? undefined : (values[i] ?? null);
    }));
  });
  return [times, ...traces];
}
