// A panel on the screen: its widgets on a grid. In edit mode the user moves and sizes them by pointer or
// arrow keys.
import type { Port } from "../model/part";
import type { Parts } from "../model/parts";
import type { Unsubscribe } from "../common/signal";
import { acceptPorts } from "../ui/drag";
import { h, iconButton } from "../ui/dom";
import { icons } from "../ui/icons";
import { reportError } from "../ui/toasts";
import { freePlace, kColumns, kMostRows, kMostWidgets, type PanelData, type WidgetData, type WidgetType } from "./file";
import { kKinds, newWidget, usualType } from "./kinds";
import { bind, type Context, type Widget } from "./widget";

const kRowHeight = 26; // px, as in styles/panel.css
const kPeriodMs = 50;

interface Placed {
  data: WidgetData;
  context: Context;
  widget: Widget;
  element: HTMLElement;
}

export class PanelView {
  readonly element = h("div", { class: "panel-grid" });
  onChange: () => void = () => undefined;
  onSelect: (data: WidgetData | null) => void = () => undefined;
  panel: PanelData;
  private placed: Placed[] = [];
  private editing = false;
  private leases: Unsubscribe[] = [];

  constructor(panel: PanelData, private readonly parts: Parts) {
    this.panel = panel;
    parts.list.watch(() => this.build());
    acceptPorts(this.element, parts, (ports) => this.addPorts(ports));
    setInterval(() => this.update(), kPeriodMs);
  }

  show(panel: PanelData): void {
    this.panel = panel;
    this.build();
  }

  setEditing(on: boolean): void {
    this.editing = on;
    this.element.classList.toggle("editing", on);
    for (const { element } of this.placed) element.tabIndex = on ? 0 : -1;
  }

  // Null: the panel is full. With more widgets it could not be loaded again.
  add(type: WidgetType, ports: readonly Port[]): WidgetData | null {
    const [w, h] = kKinds[type].size;
    const place = freePlace(this.panel.widgets, w, h);
    if (this.panel.widgets.length >= kMostWidgets || place.y > kMostRows) {
      reportError(new Error(`The panel is full: it has ${this.panel.widgets.length} widgets`));
      return null;
    }
    const data = newWidget(type, ports, place);
    this.panel.widgets.push(data);
    this.changed();
    return data;
  }

  remove(data: WidgetData): void {
    this.panel.widgets = this.panel.widgets.filter((other) => other !== data);
    this.changed();
  }

  changed(): void {
    this.build();
    this.onChange();
  }

  // The parts whose lease this panel's controls need and this page does not hold.
  partsToLease(): Set<string> {
    const wanted = this.placed.filter(({ data }) => kKinds[data.type].commands).flatMap(({ context }) => context.ports);
    return new Set(wanted.filter((port) => port.side === "input" && !port.part.leased.value).map((port) => port.part.name));
  }

  private addPorts(ports: Port[]): void {
    if (ports.length > 1 && ports.every((port) => port.side === "output")) this.add("scope", ports.slice(0, 8));
    else for (const port of ports) this.add(usualType(port), [port]);
  }

  private build(): void {
    // A scope's recording outlives the scope
    const kept = this.parts.list.value.map((part) => part.record([]));
    for (const { widget } of this.placed) widget.dispose?.();
    for (const stop of this.leases) stop();
    this.placed = this.panel.widgets.map((data) => this.place(data));
    for (const stop of kept) stop();
    this.element.replaceChildren(...this.placed.map(({ element }) => element));
    this.leases = this.parts.list.value.map((part) => part.leased.watch(() => this.enable()));
    this.setEditing(this.editing);
    this.parts.plotted().catch(reportError);
  }

  private place(data: WidgetData): Placed {
    const context = bind(data, this.parts);
    const widget = kKinds[data.type].make(context);
    const missing = data.ports.length > context.ports.length;
    const element = h(
      "div",
      { class: "widget", role: "group", "aria-label": data.label || kKinds[data.type].title },
      data.type === "button" || data.type === "label" ? null : h("div", { class: "widget-label" }, data.label),
      missing && this.parts.list.value.length > 0 ? h("div", { class: "missing" }, "no such port here") : widget.body,
      h("span", { class: "size-handle", "aria-hidden": "true" }),
      iconButton(icons.close, `Remove ${data.label}`, () => this.remove(data), { class: "icon remove" }),
    );
    lay(element, data);
    const placed = { data, context, widget, element };
    this.makeMovable(placed);
    return placed;
  }

  private enable(): void {
    for (const { data, context, widget } of this.placed)
      if (kKinds[data.type].commands) widget.setEnabled?.(context.ports.length > 0 && context.ports.every((port) => port.part.leased.value || port.side === "output"));
  }

  private update(): void {
    if (document.hidden || this.element.offsetParent === null) return;
    for (const { widget } of this.placed) widget.update();
  }

  private makeMovable({ data, element }: Placed): void {
    element.addEventListener("focusin", () => this.editing && this.onSelect(data));
    element.addEventListener("pointerdown", (event) => {
      if (!this.editing || (event.target as HTMLElement).closest(".remove")) return;
      event.preventDefault();
      element.focus();
      this.drag(event, data, element);
    });
    element.addEventListener("keydown", (event) => {
      const step = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
      if (!this.editing || event.target !== element) return;
      if (event.key === "Delete") return this.remove(data);
      if (!step) return;
      event.preventDefault();
      this.move(data, element, step[0]!, step[1]!, event.shiftKey);
    });
  }

  private drag(start: PointerEvent, data: WidgetData, element: HTMLElement): void {
    const sizing = (start.target as HTMLElement).classList.contains("size-handle");
    const from = { ...data };
    const column = this.element.clientWidth / kColumns;
    element.setPointerCapture(start.pointerId);
    const follow = (event: PointerEvent) => {
      const dx = Math.round((event.clientX - start.clientX) / column);
      const dy = Math.round((event.clientY - start.clientY) / kRowHeight);
      const base = sizing ? { w: from.w, h: from.h } : { x: from.x, y: from.y };
      Object.assign(data, base);
      this.move(data, element, dx, dy, sizing);
    };
    const end = () => element.removeEventListener("pointermove", follow);
    element.addEventListener("pointermove", follow);
    element.addEventListener("pointerup", end, { once: true });
    element.addEventListener("pointercancel", end, { once: true });
  }

  private move(data: WidgetData, element: HTMLElement, dx: number, dy: number, sizing: boolean): void {
    if (sizing) {
      data.w = Math.min(kColumns - data.x, Math.max(1, data.w + dx));
      data.h = Math.min(kMostRows, Math.max(1, data.h + dy));
    } else {
      data.x = Math.min(kColumns - data.w, Math.max(0, data.x + dx));
      data.y = Math.min(kMostRows, Math.max(0, data.y + dy));
    }
    lay(element, data);
    this.onChange();
  }
}

function lay(element: HTMLElement, { x, y, w, h: height }: WidgetData): void {
  element.style.gridColumn = `${x + 1} / span ${w}`;
  element.style.gridRow = `${y + 1} / span ${height}`;
}
