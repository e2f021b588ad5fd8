// A phase plot: the second port against the first.
import type { Port } from "../model/part";
import { formatValue } from "../ui/numbers";
import { cssColor, traceColor } from "../ui/palette";
import { polyline } from "../ui/polyline";
import { fit, leastSpan, type Range } from "../ui/range";
import type { Aligned } from "./merge";

const kMargin = 34; // px
const kAir = 0.05; // as a share of the span

export function drawPhase(canvas: HTMLCanvasElement, ports: readonly Port[], [, xs = [], ys = []]: Aligned): void {
  const { clientWidth: width, clientHeight: height } = canvas;
  if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
  const context = canvas.getContext("2d");
  const all = xs.map((x, i): [number, number] | null | undefined => pair(x, ys[i]));
  const points = all.filter((point): point is [number, number] => !!point);
  if (!context) return;
  context.clearRect(0, 0, width, height);
  const span = (axis: 0 | 1) => fit(points.map((point) => point[axis]), kAir, ports[axis] ? leastSpan(ports[axis].description) : 0);
  const [xRange, yRange] = [span(0), span(1)];
  if (points.length < 2 || !xRange || !yRange) return;
  const toX = (x: number) => kMargin + ((x - xRange.low) / (xRange.high - xRange.low)) * (width - 1.5 * kMargin);
  const toY = (y: number) => height - kMargin - ((y - yRange.low) / (yRange.high - yRange.low)) * (height - 1.5 * kMargin);
  frame(context, width, height, ports, xRange, yRange);
  context.strokeStyle = traceColor(0);
  context.lineWidth = 1.5;
  context.beginPath();
  polyline(context, all.map((point) => point && [toX(point[0]), toY(point[1])]));
  context.stroke();
  const [x, y] = points.at(-1)!;
  context.fillStyle = traceColor(1);
  context.fillRect(toX(x) - 4, toY(y) - 4, 8, 8);
}

// Null if either port has a gap, undefined if only one of them has a sample.
function pair(x: number | null | undefined, y: number | null | undefined): [number, number] | null | undefined {
  if (x === null || y === null) return null;
  return x === undefined || y === undefined ? undefined : [x, y];
}

function frame(context: CanvasRenderingContext2D, width: number, height: number, ports: readonly Port[], x: Range, y: Range): void {
  context.strokeStyle = cssColor("--line");
  context.strokeRect(kMargin, kMargin / 2, width - 1.5 * kMargin, height - 1.5 * kMargin);
  context.fillStyle = cssColor("--ink-soft");
  context.font = "11px sans-serif";
  const name = (port: Port | undefined) => (port ? `${port.description.name} [${port.description.unit || "1"}]` : "");
  context.textAlign = "center";
  context.fillText(name(ports[0]), width / 2, height - 6);
  context.save();
  context.translate(12, height / 2);
  context.rotate(-Math.PI / 2);
  context.fillText(name(ports[1]), 0, 0);
  context.restore();
  context.textAlign = "left";
  context.fillText(formatValue(x.low), kMargin, height - 20);
  context.fillText(formatValue(y.high), kMargin + 3, kMargin / 2 + 11);
  context.textAlign = "right";
  context.fillText(formatValue(x.high), width - kMargin / 2, height - 20);
}
