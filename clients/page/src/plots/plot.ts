// One plot: ports against time, or the second port against the first (phase plot). It follows the time. A
// second recording's ports are dashed lines of the same colour.
// Dragging zooms in and stops that, and a double click resumes it. The legend shows the values at the cursor.
import uPlot from "uplot";
import type { Signal } from "../common/signal";
import type { History } from "../model/history";
import type { Part, Port } from "../model/part";
import type { Parts } from "../model/parts";
import { nameOf, type PortName } from "../ui/drag";
import { h, iconButton } from "../ui/dom";
import { download } from "../ui/files";
import { icons } from "../ui/icons";
import { formatOf } from "../ui/numbers";
import { cssColor, traceColor, traceDash } from "../ui/palette";
import { fit, leastSpan } from "../ui/range";
import { reportError } from "../ui/toasts";
import { toCsv } from "./csv";
import { align, type Aligned } from "./merge";
import { gapsOf, shadeGaps } from "./gaps";
import { drawPhase } from "./phase";

const kWindows = [5, 10, 30, 60, 120, 300];
const kAir = 0.08; // above and below, as a share of the span
const kLeastLength = 0.1; // s, of the time axis in the world's first moments

const kDashOfB = [6, 3];

interface Trace {
  port: Port;
  color: string;
  dash: number[];
  name: string;
}

// A plot as it is kept.
export interface PlotData {
  ports: PortName[];
  seconds: number; // of its time axis
}

const kGaps = "Shaded: this page was too busy to take the samples. A recording has them all.";

export class Plot {
  readonly element: HTMLElement;
  readonly ports: Port[] = [];
  private readonly place = h("div", { class: "plot-place" });
  private readonly phaseCanvas = h("canvas", { class: "phase", hidden: true, role: "img", "aria-label": "Phase plot" });
  private readonly seconds = h("select", { "aria-label": "Length of the time axis" }, ...kWindows.map((s) => h("option", { value: s, selected: s === 10 }, s < 60 ? `${s} s` : `${s / 60} min`)));
  private readonly gapNote = h("p", { class: "gap-note", hidden: true }, kGaps);
  private readonly phase: HTMLButtonElement;
  private readonly stops = new Map<Port, () => void>(); // they end the recording
  private plot: uPlot | null = null;
  private readonly stopWatching: () => void;
  private zoom: { from: number; to: number } | null = null;

  constructor(ports: readonly Port[], onClose: () => void, private readonly onChange: () => void, private readonly beside: Signal<string>) {
    this.phase = h("button", { type: "button", class: "small", "aria-pressed": "false", title: "The second port against the first", onclick: () => this.togglePhase() }, "Phase");
    this.element = h("section", { class: "plot", "aria-label": "Plot" },
      h("div", { class: "plot-tools" }, this.seconds, this.phase,
        iconButton(icons.download, "Export as CSV", () => this.exportCsv()),
        iconButton(icons.image, "Export as PNG", () => this.exportPng()),
        iconButton(icons.close, "Close the plot", onClose)),
      this.place, this.phaseCanvas, this.gapNote);
    this.seconds.addEventListener("change", onChange);
    new ResizeObserver(() => this.resize()).observe(this.place);
    this.stopWatching = beside.watch(() => this.plot && this.rebuild());
    this.add(ports);
  }

  // Adds as many ports as can be recorded.
  add(ports: readonly Port[]): void {
    for (const port of ports.filter((port) => !this.ports.includes(port))) this.take(port);
    this.rebuild();
  }

  get data(): PlotData {
    return { ports: this.ports.map(nameOf), seconds: Number(this.seconds.value) };
  }
  setSeconds(seconds: number): void {
    if (kWindows.includes(seconds)) this.seconds.value = String(seconds);
  }

  // After a restart the parts may be other objects. Takes the same ports of those.
  rebind(parts: Parts): void {
    const now = this.ports.map((port) => parts.port(port.part.name, port.description.name) ?? port);
    if (now.every((port, i) => port === this.ports[i])) return;
    this.ports.splice(0, this.ports.length, ...now);
    this.rebuild();
  }

  dispose(): void {
    for (const stop of this.stops.values()) stop();
    this.stops.clear();
    this.stopWatching();
    this.plot?.destroy();
  }

  // Draws what is new. `now`: simulated time, s.
  update(now: number): void {
    if (this.element.offsetParent === null) return;
    const length = Number(this.seconds.value);
    const from = this.zoom?.from ?? Math.max(0, now - length); // no time is below 0
    const to = this.zoom?.to ?? Math.max(now, kLeastLength);
    const data = this.window(from, to);
    if (!this.phaseCanvas.hidden) return drawPhase(this.phaseCanvas, this.traced(), data);
    this.gapNote.hidden = gapsOf(data[0], data.slice(1) as (number | null | undefined)[][]).length === 0;
    this.plot?.setData(data as uPlot.AlignedData, false);
    this.plot?.setScale("x", { min: from, max: to });
  }

  private window(from: number, to: number): Aligned {
    const width = Math.max(100, this.place.clientWidth);
    const parts = this.byPart();
    const windows = (historyOf: (part: Part) => History | null) => parts.map(([part, ports]) =>
      historyOf(part)?.window(from, to, width, ports.map((port) => part.channel(port))) ?? { times: [], values: ports.map(() => []) });
    return align([...windows((part) => part.recordings()), ...(this.beside.value === "" ? [] : windows((part) => part.besides()))]);
  }

  private take(port: Port): void {
    try {
      this.stops.set(port, port.part.record([port]));
      this.ports.push(port);
    } catch (error) {
      reportError(error);
    }
  }

  // In the order of the traces.
  private traced(): Port[] {
    return this.byPart().flatMap(([, ports]) => ports);
  }

  // The lines of the plot, in the order of its data: first those of the world, then those of B.
  private traces(): Trace[] {
    const own = this.traced().map((port, i): Trace => ({ port, color: traceColor(i), dash: traceDash(i), name: port.description.name }));
    if (this.beside.value === "") return own;
    return [...own, ...own.map((trace): Trace => ({ ...trace, dash: kDashOfB, name: `${trace.name} · B` }))];
  }

  // Ports in the order of the traces: part by part.
  private byPart(): [Part, Port[]][] {
    const parts = [...new Set(this.ports.map((port) => port.part))];
    return parts.map((part) => [part, this.ports.filter((port) => port.part === part)]);
  }

  private rebuild(): void {
    this.plot?.destroy();
    this.plot = this.ports.length > 0 ? new uPlot(this.options(), [[]], this.place) : null;
    this.resize(); // the legend's height is known only now
    this.phase.disabled = this.ports.length < 2;
    this.onChange();
  }

  private options(): uPlot.Options {
    const units = [...new Set(this.ports.map((port) => port.description.unit))];
    const axis = { stroke: cssColor("--ink-soft"), grid: { stroke: cssColor("--line"), width: 1 }, ticks: { stroke: cssColor("--line"), width: 1 }, font: "11px sans-serif" };
    return {
      ...this.size(),
      cursor: { drag: { x: true, y: false, setScale: false }, points: { size: 6 } },
      legend: { live: true },
      scales: { x: { time: false }, ...Object.fromEntries(units.map((unit) => [unit || "1", { range: (_: uPlot, low: number | null, high: number | null) => this.valueRange(unit, low, high) }])) },
      axes: [{ ...axis, size: 26 }, ...units.slice(0, 2).map((unit, i) => ({ ...axis, scale: unit || "1", side: (i === 0 ? 3 : 1) as uPlot.Axis.Side, size: 52, label: unit, labelSize: 14, labelFont: "11px sans-serif", grid: { ...axis.grid, show: i === 0 } }))],
      series: [{ label: "t", value: (_, value) => (value === null ? "–" : `${value.toFixed(3)} s`) },
        ...this.traces().map(({ port, color, dash, name }) => ({ label: name, scale: port.description.unit || "1", stroke: color, dash, width: 1.5, spanGaps: true, points: { show: false },
          value: (_: uPlot, value: number | null | undefined) => (value === null || value === undefined ? "–" : `${formatOf(port.description, value)} ${port.description.unit}`) }))],
      hooks: {
        drawClear: [shadeGaps],
        setSelect: [(plot) => this.zoomTo(plot)],
        ready: [(plot) => plot.over.addEventListener("dblclick", () => (this.zoom = null))],
      },
    };
  }

  // While the plot follows the time, a value that stands still is a line in the middle. Zoomed in, the noise
  // shows, too.
  private valueRange(unit: string, low: number | null, high: number | null): uPlot.Range.MinMax {
    const spans = this.ports.filter((port) => port.description.unit === unit).map((port) => leastSpan(port.description));
    const range = fit([low, high], kAir, this.zoom ? 0 : Math.min(...spans));
    return range ? [range.low, range.high] : [0, 1];
  }

  private zoomTo(plot: uPlot): void {
    const { left, width } = plot.select;
    if (width < 4) return;
    this.zoom = { from: plot.posToVal(left, "x"), to: plot.posToVal(left + width, "x") };
    plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
  }

  private togglePhase(): void {
    const on = this.phaseCanvas.hidden;
    this.phaseCanvas.hidden = !on;
    this.place.hidden = on;
    this.phase.setAttribute("aria-pressed", String(on));
  }

  private size(): { width: number; height: number } {
    const legend = this.place.querySelector<HTMLElement>(".u-legend")?.offsetHeight ?? 22;
    return { width: Math.max(160, this.place.clientWidth), height: Math.max(80, this.place.clientHeight - legend) };
  }
  private resize(): void {
    this.plot?.setSize(this.size());
  }

  private exportCsv(): void {
    const columns = (historyOf: (part: Part) => History | null, of: string) => this.byPart().flatMap(([part, ports]) => {
      const series = historyOf(part)?.all(ports.map((port) => part.channel(port)));
      return ports.map((port, i) => ({ name: `${part.name} ${port.description.name}${of} [${port.description.unit || "1"}]`, times: series?.times ?? [], values: series?.values[i] ?? [] }));
    });
    const ofB = this.beside.value === "" ? [] : columns((part) => part.besides(), " · B");
    download("visum.csv", new Blob([toCsv([...columns((part) => part.recordings(), ""), ...ofB])], { type: "text/csv" }));
  }

  // The plot on the colour of paper, with its legend as text below.
  private exportPng(): void {
    const source = this.phaseCanvas.hidden ? this.plot?.ctx.canvas : this.phaseCanvas;
    if (!source) return;
    const canvas = h("canvas", { width: source.width, height: source.height + 22 * this.traces().length + 8 });
    const context = canvas.getContext("2d")!;
    context.fillStyle = cssColor("--surface");
    context.fillRect(0, 0, canvas.width, canvas.height);
    context.drawImage(source, 0, 0);
    context.font = "13px sans-serif";
    this.traces().forEach(({ port, color, dash, name }, i) => {
      const y = source.height + 22 * i + 14;
      context.strokeStyle = color;
      context.lineWidth = 3;
      context.setLineDash(dash);
      context.beginPath();
      context.moveTo(16, y - 4);
      context.lineTo(38, y - 4);
      context.stroke();
      context.fillStyle = cssColor("--ink");
      context.fillText(`${port.part.name} · ${name} [${port.description.unit || "1"}]`, 46, y);
    });
    canvas.toBlob((blob) => blob && download("visum.png", blob));
  }
}
