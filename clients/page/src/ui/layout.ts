// The places of the page: bar, parts on the left, view in the middle, panel on the right, plots and log
// below. Each pane around the view can be closed, and the browser remembers which are open. On a small
// screen one of them at a time shares the screen with the view.
import { Emitter } from "../common/signal";
import { h } from "./dom";

export type PaneName = "parts" | "panel" | "plots" | "log";
export type OpenPanes = Record<PaneName, boolean>;
const kTitles: Record<PaneName, string> = { parts: "Parts", panel: "Panel", plots: "Plots", log: "Log" };
// Two hundred ports lie between the bar and the view for those who walk by keys.
const kSkips: [string, string][] = [["Skip to the world", "world"], ["Skip to the panel", "panel"]];
// On a small screen the first that was open stays.
const kOrder: PaneName[] = ["panel", "parts", "plots", "log"];
const kStored = "visum.panes";
const kNarrow = "(max-width: 999px)"; // one pane at a time stands below or beside the view then

export class Layout {
  readonly bar = h("header", { class: "bar" });
  readonly view = h("main", { class: "view", id: "world", tabindex: -1, "aria-label": "World" });
  readonly panes: Record<PaneName, HTMLElement>;
  readonly root: HTMLElement;
  readonly toggles: HTMLElement;
  readonly changed = new Emitter<void>(); // a pane was opened or closed
  private readonly open: OpenPanes;
  private readonly buttons: Record<PaneName, HTMLButtonElement>;

  constructor() {
    const pane = (name: PaneName) => h("aside", { class: `pane ${name}`, id: name, tabindex: -1, "aria-label": kTitles[name] });
    this.panes = { parts: pane("parts"), panel: pane("panel"), plots: pane("plots"), log: pane("log") };
    const button = (name: PaneName) => h("button", { type: "button", class: "toggle", onclick: () => this.toggle(name) }, kTitles[name]);
    this.buttons = { parts: button("parts"), panel: button("panel"), plots: button("plots"), log: button("log") };
    this.toggles = h("div", { class: "toggles", role: "group", "aria-label": "Panes" }, ...Object.values(this.buttons));
    const skip = ([name, id]: [string, string]) => h("a", { class: "skip", href: `#${id}` }, name);
    this.root = h("div", { class: "layout" },
      h("nav", { class: "skips", "aria-label": "Skip" }, ...kSkips.map(skip)), this.bar, this.panes.parts, this.view, this.panes.panel, h("div", { class: "bottom" }, this.panes.plots, this.panes.log));
    this.open = this.remembered();
    const narrow = matchMedia(kNarrow);
    const fit = () => {
      if (narrow.matches) this.keepOnly(kOrder.find((name) => this.open[name]));
      this.show();
    };
    narrow.addEventListener("change", fit);
    fit();
  }

  // A pane without content takes no room, and has no button.
  offer(name: PaneName, on: boolean): void {
    if (on === !this.buttons[name].hidden) return;
    this.buttons[name].hidden = !on;
    this.show();
  }

  reveal(name: PaneName): void {
    if (!this.open[name]) this.toggle(name);
  }

  get openPanes(): OpenPanes {
    return { ...this.open };
  }

  use(panes: OpenPanes): void {
    Object.assign(this.open, panes);
    if (matchMedia(kNarrow).matches) this.keepOnly(kOrder.find((name) => this.open[name]));
    this.keep();
  }

  private toggle(name: PaneName): void {
    this.open[name] = !this.open[name];
    if (this.open[name] && matchMedia(kNarrow).matches) this.keepOnly(name);
    this.keep();
  }

  private keep(): void {
    localStorage.setItem(kStored, JSON.stringify(this.open));
    this.show();
    this.changed.emit();
  }

  private keepOnly(name: PaneName | undefined): void {
    for (const other of kOrder) this.open[other] = other === name;
  }

  private show(): void {
    for (const name of Object.keys(this.panes) as PaneName[]) {
      const open = this.open[name] && !this.buttons[name].hidden;
      this.panes[name].hidden = !open;
      this.root.dataset[name] = open ? "open" : "closed";
      this.buttons[name].setAttribute("aria-pressed", String(open));
    }
  }

  private remembered(): OpenPanes {
    const usual = { parts: true, panel: true, plots: false, log: false };
    try {
      return { ...usual, ...(JSON.parse(localStorage.getItem(kStored) ?? "{}") as object) };
    } catch {
      return usual;
    }
  }
}
