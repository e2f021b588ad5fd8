// The lines of a sensor's view in its own frame: it looks along x, and z is up. Pure functions.
import type { SensorDescription } from "../link/messages";

export type Point = [number, number, number];

// The points where the rays ended. A reading at an end of the range means that nothing was there, or that it
// was too near.
export function hits({ range, angle }: Pick<SensorDescription, "range" | "angle">, distances: ArrayLike<number>): Point[] {
  const [lowest = 0, highest = 0] = range;
  const [first = 0, last = first] = angle;
  const found: Point[] = [];
  for (let i = 0; i < distances.length; ++i) {
    const distance = distances[i]!;
    if (!(distance > lowest && distance < highest)) continue;
    const turn = distances.length === 1 ? first : first + ((last - first) * i) / (distances.length - 1);
    found.push([distance * Math.cos(turn), distance * Math.sin(turn), 0]);
  }
  return found;
}

// The four corners of the picture at `depth` along the axis: upper left, upper right, lower right, lower
// left.
export function corners({ fov, aspect }: Pick<SensorDescription, "fov" | "aspect">, depth: number): Point[] {
  const side = depth * Math.tan(fov / 2);
  const up = side / aspect;
  return [[depth, side, up], [depth, -side, up], [depth, -side, -up], [depth, side, -up]];
}

// The edges of a camera's frustum as pairs of points: from its eye to as far as it sees, closed there. That
// end is far away, so the edges are closed at `near` too, where a tick marks the upper edge.
export function frustumEdges(sensor: Pick<SensorDescription, "fov" | "aspect" | "range">, near: number): Point[] {
  const far = corners(sensor, sensor.range[1] ?? near);
  const close = corners(sensor, Math.min(near, sensor.range[1] ?? near));
  const frame = (of: Point[]) => of.flatMap((corner, i): Point[] => [corner, of[(i + 1) % of.length]!]);
  const [left, right] = [close[0]!, close[1]!];
  const tip: Point = [left[0], 0, 1.4 * left[2]];
  return [...far.flatMap((corner): Point[] => [[0, 0, 0], corner]), ...frame(far), ...frame(close), left, tip, tip, right];
}
