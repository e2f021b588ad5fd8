// An oscilloscope: the last seconds of up to eight ports, against a left and a right scale. It takes as many
// samples as it can show; a plot takes every tick.
import type { Port } from "../model/part";
import { h } from "../ui/dom";
import { formatInRange } from "../ui/numbers";
import { cssColor, traceColor } from "../ui/palette";
import { polyline } from "../ui/polyline";
import { fit, leastSpan, type Range } from "../ui/range";
import { reportError } from "../ui/toasts";
import type { Context, Widget } from "./widget";

interface Trace {
  times: number[];
  values: (number | null)[]; // null: a gap
}

const kSeconds = 5;
const kMargin = 0.08;
const kSamples = 400; // over its width: about two for each pixel

export function scope({ data, ports }: Context): Widget {
  const canvas = h("canvas", { "aria-hidden": "true" });
  const legend = h("div", { class: "scope-legend" }, ...ports.map((port, i) => h("span", {}, swatch(i), port.description.name, data.scales?.[i] === 1 ? " ▸" : "")));
  const periodMs = ((data.seconds ?? kSeconds) * 1000) / kSamples;
  const stops = ports.map((port) => record(port, periodMs));
  let drawn = false; // by the last update: a curve is drawn at half the pace of numbers, as plots are
  return {
    body: h("div", { class: "w-scope" }, canvas, legend),
    update: () => void ((drawn = !drawn) && draw(canvas, ports, data.scales ?? [], data.seconds ?? kSeconds)),
    dispose: () => stops.forEach((stop) => stop()),
  };
}

// Ports beyond the limit have no trace.
function record(port: Port, periodMs: number): () => void {
  try {
    return port.part.record([port], periodMs);
  } catch (error) {
    reportError(error);
    return () => undefined;
  }
}

function swatch(index: number): HTMLElement {
  const element = h("i", { class: "swatch" });
  element.style.background = traceColor(index);
  return element;
}

function draw(canvas: HTMLCanvasElement, ports: Port[], scales: number[], seconds: number): void {
  const { clientWidth: width, clientHeight: height } = canvas;
  if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
  const context = canvas.getContext("2d");
  if (!context || width === 0) return;
  context.clearRect(0, 0, width, height);
  const now = Math.max(...ports.map((port) => port.part.recordings()?.lastTime ?? NaN));
  const traces = ports.map((port) => traceOf(port, now - seconds, now, width));
  drawGrid(context, width, height);
  for (const side of [0, 1]) {
    const mine = ports.map((_, i) => i).filter((i) => (scales[i] ?? 0) === side);
    const least = Math.min(...mine.map((i) => leastSpan(ports[i]!.description)));
    const range = fit(mine.flatMap((i) => traces[i]!.values), kMargin, least);
    if (!range) continue;
    drawScale(context, range, side === 0 ? 4 : width - 4, height);
    for (const i of mine) drawTrace(context, traces[i]!, i, range, (time) => ((time - now + seconds) / seconds) * width, height);
  }
}

function traceOf(port: Port, from: number, to: number, width: number): Trace {
  const history = port.part.recordings();
  const channel = port.part.channel(port);
  if (!history || channel < 0) return { times: [], values: [] };
  const series = history.window(from, to, width, [channel]);
  return { times: series.times, values: series.values[0]! };
}

function drawGrid(context: CanvasRenderingContext2D, width: number, height: number): void {
  context.strokeStyle = cssColor("--line");
  context.lineWidth = 1;
  context.beginPath();
  for (let i = 1; i < 10; ++i) context.moveTo((i * width) / 10, 0), context.lineTo((i * width) / 10, height);
  for (let i = 1; i < 4; ++i) context.moveTo(0, (i * height) / 4), context.lineTo(width, (i * height) / 4);
  context.stroke();
}

function drawScale(context: CanvasRenderingContext2D, { low, high }: Range, x: number, height: number): void {
  context.fillStyle = cssColor("--ink-soft");
  context.font = "10px sans-serif";
  context.textAlign = x < 10 ? "left" : "right";
  context.fillText(formatInRange(high, low, high, " "), x, 11);
  context.fillText(formatInRange(low, low, high, " "), x, height - 4);
}

function drawTrace(context: CanvasRenderingContext2D, trace: Trace, index: number, { low, high }: Range, xOf: (time: number) => number, height: number): void {
  context.strokeStyle = traceColor(index);
  context.lineWidth = 1.5;
  context.beginPath();
  const yOf = (value: number) => height - ((value - low) / (high - low)) * height;
  polyline(context, trace.times.map((time, n) => {
    const value = trace.values[n];
    return value === null || value === undefined ? null : [xOf(time), yOf(value)];
  }));
  context.stroke();
}
