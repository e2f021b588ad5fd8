// The places of the page: bar, parts on the left, view in the middle, panel on the right, plots below. Each
// of the three around the view can be closed, and the browser remembers which are open.
import { h } from "./dom";

export type PaneName = "parts" | "panel" | "plots";
const kTitles: Record<PaneName, string> = { parts: "Parts", panel: "Panel", plots: "Plots" };
const kStored = "visum.panes";
const kNarrow = "(max-width: 999px)"; // one pane at a time covers the view then

export class Layout {
  readonly bar = h("header", { class: "bar" });
  readonly view = h("main", { class: "view", "aria-label": "World" });
  readonly panes: Record<PaneName, HTMLElement>;
  readonly root: HTMLElement;
  readonly toggles: HTMLElement;
  private readonly open: Record<PaneName, boolean>;
  private readonly buttons: Record<PaneName, HTMLButtonElement>;

  constructor() {
    const pane = (name: PaneName) => h("aside", { class: `pane ${name}`, "aria-label": kTitles[name] });
    this.panes = { parts: pane("parts"), panel: pane("panel"), plots: pane("plots") };
    const button = (name: PaneName) => h("button", { type: "button", class: "toggle", onclick: () => this.toggle(name) }, kTitles[name]);
    this.buttons = { parts: button("parts"), panel: button("panel"), plots: button("plots") };
    this.toggles = h("div", { class: "toggles", role: "group", "aria-label": "Panes" }, ...Object.values(this.buttons));
    this.root = h("div", { class: "layout" }, this.bar, this.panes.parts, this.view, this.panes.panel, this.panes.plots);
    this.open = this.remembered();
    const narrow = matchMedia(kNarrow);
    const fit = () => {
      if (narrow.matches && this.open.parts) this.open.panel = false;
      this.show();
    };
    narrow.addEventListener("change", fit);
    fit();
  }

  reveal(name: PaneName): void {
    if (!this.open[name]) this.toggle(name);
  }

  private toggle(name: PaneName): void {
    this.open[name] = !this.open[name];
    if (this.open[name] && matchMedia(kNarrow).matches && name !== "plots") this.open[name === "parts" ? "panel" : "parts"] = false;
    localStorage.setItem(kStored, JSON.stringify(this.open));
    this.show();
  }

  private show(): void {
    for (const name of Object.keys(this.panes) as PaneName[]) {
      this.panes[name].hidden = !this.open[name];
      this.root.dataset[name] = this.open[name] ? "open" : "closed";
      this.buttons[name].setAttribute("aria-pressed", String(this.open[name]));
    }
  }

  private remembered(): Record<PaneName, boolean> {
    const usual = { parts: true, panel: true, plots: false };
    try {
      return { ...usual, ...(JSON.parse(localStorage.getItem(kStored) ?? "{}") as object) };
    } catch {
      return usual;
    }
  }
}
