// A line through points. Null is a gap; undefined is skipped. Pure.
export function polyline(path: Pick<CanvasPath, "moveTo" | "lineTo">, points: Iterable<readonly [number, number] | null | undefined>): void {
  let down = false;
  for (const point of points) {
    if (point === undefined) continue;
    if (point && down) path.lineTo(...point);
    else if (point) path.moveTo(...point);
    down = point !== null;
  }
}
