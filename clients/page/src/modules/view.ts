// Shows the modules of controllers as a graph, one opened group at a time.
import type { Link } from "../link/link";
import type { ModulePart } from "../link/messages";
import { poll } from "../model/poll";
import { h, setText } from "../ui/dom";
import { formatNs, formatValue } from "../ui/numbers";
import { graphOf, labelOf, type Graph, type GraphEdge, type GraphNode } from "./graph";

const kPollMs = 250;
const kRowPx = 118;
const kNodePx = 58;
const kSvg = "http://www.w3.org/2000/svg";

export class ModulesView {
  readonly element: HTMLElement;
  private readonly trail = h("nav", { class: "modules-trail", "aria-label": "Opened group" });
  private readonly canvas = h("div", { class: "modules-graph" });
  private readonly list = h("table", { class: "modules-values" });
  private readonly none = h("p", { class: "empty" }, "No controller has announced modules.");
  private parts: ModulePart[] = [];
  private revision = 0n;
  private path: string[] = [];
  private chosen = ""; // of an edge, whose values are listed
  private shown = "";
  private readonly labels = new Map<string, HTMLElement>(); // of edges
  private readonly times = new Map<string, HTMLElement>();

  constructor(private readonly link: Link) {
    this.element = h("section", { class: "tab-body modules" }, this.trail, this.none, this.canvas, this.list);
    link.state.watch(() => {
      this.revision = 0n;
      this.parts = [];
    });
    poll(() => this.refresh(), kPollMs);
  }

  private async refresh(): Promise<void> {
    if (document.hidden || this.element.hidden || !this.link.welcome) return;
    try {
      const list = await this.link.request({ case: "listModules", value: { knownRevision: this.revision } }, "modules");
      if (list.revision === this.revision) {
        list.parts.forEach((part, i) => {
          if (part.reported && this.parts[i]) this.parts[i].reported = part.reported;
        });
      } else {
        this.parts = list.parts;
        this.revision = list.revision;
      }
      this.draw();
    } catch {
      // A server before this request, or a connection that ends: the next one asks again.
    }
  }

  private open(path: string[]): void {
    this.path = path;
    this.chosen = "";
    this.draw();
  }

  private draw(): void {
    if (this.path.length > 0 && !this.parts.some(({ announced }) => announced?.part === this.path[0])) this.path = [];
    const graph = graphOf(this.parts, this.path);
    this.none.hidden = this.parts.length > 0;
    const form = JSON.stringify([this.path, graph.nodes.map(({ id, layer, kind }) => [id, layer, kind]), graph.edges.map(({ from, to, down }) => [from, to, down])]);
    if (form !== this.shown) this.build(graph);
    this.shown = form;
    for (const one of graph.nodes) this.update(one);
    for (const edge of graph.edges) {
      const label = this.labels.get(keyOf(edge));
      if (label) setText(label, labelOf(edge, formatValue));
    }
    this.listValues(graph.edges.find((edge) => keyOf(edge) === this.chosen));
  }

  private build(graph: Graph): void {
    const steps = ["All parts", ...this.path].map((name, i) =>
      h("button", { type: "button", disabled: i === this.path.length, onclick: () => this.open(this.path.slice(0, i)) }, name));
    this.trail.replaceChildren(...steps);
    this.labels.clear();
    this.times.clear();
    const lines = document.createElementNS(kSvg, "svg");
    lines.setAttribute("aria-hidden", "true");
    lines.setAttribute("viewBox", "0 0 100 100");
    lines.setAttribute("preserveAspectRatio", "none");
    const places = placesOf(graph);
    const height = (Math.max(0, ...graph.nodes.map(({ layer }) => layer)) + 1) * kRowPx;
    const labels = graph.edges.map((edge) => this.makeEdge(edge, places, height, lines));
    this.canvas.style.height = `${graph.nodes.length > 0 ? height : 0}px`;
    this.canvas.replaceChildren(lines, ...graph.nodes.map((one) => this.makeNode(one, places.get(one.id)!)), ...labels);
  }

  private makeNode(one: GraphNode, place: { x: number; y: number }): HTMLElement {
    const time = h("span", { class: "modules-time" });
    this.times.set(one.id, time);
    const content = [h("span", { class: "modules-name" }, one.name), time];
    const opens = one.opens;
    const element = opens
      ? h("button", { type: "button", title: `Open ${one.name}`, onclick: () => this.open(opens) }, ...content)
      : h("div", {}, ...content);
    element.className = "modules-node";
    element.dataset["kind"] = one.kind;
    element.style.left = `${place.x}%`;
    element.style.top = `${place.y}px`;
    return element;
  }

  // Commands on the left of a node, sensor values on its right.
  private makeEdge(edge: GraphEdge, places: Map<string, { x: number; y: number }>, height: number, lines: SVGElement): HTMLElement {
    const from = places.get(edge.from)!;
    const to = places.get(edge.to)!;
    const shift = edge.down ? -4 : 4;
    const end = (one: { x: number; y: number }, isStart: boolean) => ({ x: one.x + shift, y: one.y + (edge.down === isStart ? kNodePx : 0) });
    const [a, b] = [end(from, true), end(to, false)];
    const line = document.createElementNS(kSvg, "line");
    for (const [name, value] of Object.entries({ x1: a.x, y1: (100 * a.y) / height, x2: b.x, y2: (100 * b.y) / height })) line.setAttribute(name, String(value));
    line.setAttribute("class", edge.down ? "modules-down" : "modules-up");
    line.setAttribute("vector-effect", "non-scaling-stroke");
    lines.append(line);
    const what = `${edge.down ? "Control" : "Sense"} from ${edge.from} to ${edge.to}`;
    const label = h("button", { type: "button", class: `modules-label ${edge.down ? "modules-down" : "modules-up"}`, title: what, "aria-description": what,
      onclick: () => {
        this.chosen = this.chosen === keyOf(edge) ? "" : keyOf(edge);
        this.draw();
      } });
    label.style.left = `${(a.x + b.x) / 2}%`;
    label.style.top = `${(a.y + b.y) / 2}px`;
    this.labels.set(keyOf(edge), label);
    return label;
  }

  private update(one: GraphNode): void {
    const time = this.times.get(one.id);
    if (!time) return;
    const cycle = one.kind === "hardware" ? "hardware part" : one.kind === "border" ? "" : `control ${formatNs(one.controlNs)} · sense ${formatNs(one.senseNs)}`;
    const period = one.kind === "part" ? ` · every ${formatNs(one.periodNs)}` : "";
    const held = one.held.length > 0 ? ` · holds ${one.held.join(", ")}` : "";
    setText(time, cycle + period + held);
    time.parentElement!.toggleAttribute("data-held", one.held.length > 0);
  }

  private listValues(edge: GraphEdge | undefined): void {
    if (!edge) {
      if (this.list.childElementCount > 0) this.list.replaceChildren();
      return;
    }
    const rows = edge.values.map(({ name, value }) => h("tr", {}, h("th", { scope: "row" }, name), h("td", {}, formatValue(value))));
    this.list.replaceChildren(h("caption", {}, `${edge.down ? "Control" : "Sense"}: ${edge.from} to ${edge.to}`), ...rows);
  }
}

function keyOf({ from, to, down }: GraphEdge): string {
  return `${from}\n${to}\n${down}`;
}

// The centre of each node in percent of the width, and its upper side in pixels.
function placesOf(graph: Graph): Map<string, { x: number; y: number }> {
  const places = new Map<string, { x: number; y: number }>();
  for (const one of graph.nodes) {
    const row = graph.nodes.filter(({ layer }) => layer === one.layer);
    places.set(one.id, { x: (100 * (row.indexOf(one) + 0.5)) / row.length, y: one.layer * kRowPx });
  }
  return places;
}
