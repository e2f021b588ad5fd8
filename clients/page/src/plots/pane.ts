// The pane of plots, side by side. Ports come by their button in the tree, or by drag and drop.
import type { Port } from "../model/part";
import type { Parts } from "../model/parts";
import { acceptPorts } from "../ui/drag";
import { h } from "../ui/dom";
import { reportError } from "../ui/toasts";
import { Emitter } from "../common/signal";
import { Plot, type PlotData } from "./plot";

const kPeriodMs = 100;

export class PlotPane {
  readonly plots: Plot[] = [];
  readonly changed = new Emitter<void>(); // other plots, other ports in one, or another time axis
  private readonly place = h("div", { class: "plot-row" });
  private readonly empty = h("p", { class: "empty" }, "Drag ports here from the tree, or use their plot buttons.");

  constructor(pane: HTMLElement, private readonly parts: Parts) {
    pane.append(this.place, this.empty);
    acceptPorts(pane, parts, (ports, event) => {
      const over = this.plots.find(({ element }) => element.contains(event.target as Node));
      if (over) over.add(ports);
      else this.open(ports);
    });
    parts.list.watch(() => this.plots.forEach((plot) => plot.rebind(parts)));
    setInterval(() => this.update(), kPeriodMs);
  }

  // Adds ports to the last plot, or to a new one if there is none.
  plot(ports: Port[]): void {
    const last = this.plots.at(-1);
    if (last) last.add(ports);
    else this.open(ports);
  }

  open(ports: Port[]): void {
    const plot: Plot = new Plot(ports, () => this.close(plot), () => {
      this.parts.plotted().catch(reportError);
      this.changed.emit();
    }, this.parts.beside);
    if (plot.ports.length === 0) return plot.dispose();
    this.plots.push(plot);
    this.show();
  }

  get data(): PlotData[] {
    return this.plots.map(({ data }) => data);
  }

  // Opens plots as they were kept, as far as their ports are here, in place of those that are open.
  restore(list: readonly PlotData[]): void {
    for (const plot of [...this.plots]) this.close(plot);
    for (const { ports, seconds } of list) {
      const found = ports.map(({ part, port }) => this.parts.port(part, port)).filter((port): port is Port => port !== undefined);
      if (found.length === 0) continue;
      this.open(found);
      this.plots.at(-1)?.setSeconds(seconds);
    }
    this.changed.emit();
  }

  private close(plot: Plot): void {
    plot.dispose();
    this.plots.splice(this.plots.indexOf(plot), 1);
    this.parts.plotted().catch(reportError);
    this.show();
  }

  private show(): void {
    this.place.replaceChildren(...this.plots.map(({ element }) => element));
    this.empty.hidden = this.plots.length > 0;
    this.place.hidden = this.plots.length === 0;
    this.changed.emit();
  }

  private update(): void {
    if (document.hidden) return;
    const times = this.parts.list.value.map((part) => part.recordings()?.lastTime ?? NaN).filter((time) => !Number.isNaN(time));
    if (times.length > 0) for (const plot of this.plots) plot.update(Math.max(...times));
  }
}
