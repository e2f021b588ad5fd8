// All parts as a tree with a search. The visible rows are updated ten times a second.
import type { Link } from "../link/link";
import type { Part } from "../model/part";
import type { Parts } from "../model/parts";
import { h } from "../ui/dom";
import { PartView } from "./part_view";
import type { PortRow, RowActions } from "./row";

const kRefreshMs = 100;

export class Tree {
  readonly element: HTMLElement;
  private readonly search = h("input", { type: "search", placeholder: "Search ports and parameters", "aria-label": "Search ports and parameters" });
  private readonly body = h("div", {});
  private readonly empty = h("p", { class: "empty", hidden: true }, "No port and no parameter matches.");
  private views: PartView[] = [];
  private readonly rows = new Map<Element, PortRow>();
  private readonly observer = new IntersectionObserver((entries) => {
    for (const entry of entries) this.markVisible(entry);
  });

  constructor(private readonly link: Link, parts: Parts, private readonly actions: RowActions, below: HTMLElement) {
    this.element = h("div", { class: "tree" }, h("div", { class: "search" }, this.search), h("div", { class: "tree-body" }, this.body, this.empty, below));
    this.search.addEventListener("input", () => this.filter());
    parts.list.watch((list) => this.show(list));
    setInterval(() => this.refresh(), kRefreshMs);
  }

  private show(list: Part[]): void {
    // Where a part stays, its open groups and the search stay as they are.
    if (list.length === this.views.length && list.every((part, i) => part === this.views[i]?.part)) return;
    const before = this.views;
    this.views = list.map((part) => before.find((view) => view.part === part) ?? new PartView(this.link, part, this.actions));
    for (const view of before) if (!this.views.includes(view)) view.dispose();
    this.observer.disconnect();
    this.rows.clear();
    this.body.replaceChildren(...this.views.map((view) => view.element));
    for (const row of this.views.flatMap((view) => view.rows)) {
      this.rows.set(row.element, row);
      this.observer.observe(row.element);
    }
    this.filter();
  }

  private filter(): void {
    const words = this.search.value.toLowerCase().split(/\s+/).filter(Boolean);
    const found = this.views.map((view) => view.filter(words));
    this.empty.hidden = found.length === 0 || found.includes(true);
  }

  private refresh(): void {
    if (document.hidden) return;
    for (const row of this.rows.values()) row.update();
  }

  private markVisible(entry: IntersectionObserverEntry): void {
    const row = this.rows.get(entry.target);
    if (row) row.visible = entry.isIntersecting;
  }
}
