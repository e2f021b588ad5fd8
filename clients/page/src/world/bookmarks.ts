// Bookmarks: states of the world with names, to go back to. The server keeps each as a file, so they outlive
// it; this browser keeps the names, for each scene.
import type { Link } from "../link/link";
import type { World } from "../model/world";
import { h, iconButton } from "../ui/dom";
import { icons } from "../ui/icons";
import { report, reportError } from "../ui/toasts";
import { actButton, section } from "./act";

const kStored = "visum.bookmarks.";
const kMost = 50;

export class BookmarksSection {
  readonly element: HTMLElement;
  private readonly list = h("ul", { class: "bookmarks" });
  private readonly name = h("input", { type: "text", placeholder: "name", "aria-label": "Name of the bookmark" });
  private scene = "";

  constructor(private readonly link: Link, world: World) {
    const keep = actButton("Bookmark", () => this.take());
    this.name.addEventListener("keydown", (event) => event.key === "Enter" && keep.click());
    this.element = section("Bookmarks of the state", h("div", { class: "menu-row" }, this.name, keep), this.list);
    world.description.watch((description) => {
      this.scene = description?.scene ?? "";
      this.show();
    });
  }

  private async take(): Promise<string> {
    const name = this.name.value.trim() || freeName(this.names);
    await this.link.request({ case: "takeSnapshot", value: { name } }, "snapshot");
    this.name.value = "";
    this.keep([...this.names.filter((other) => other !== name), name].slice(-kMost));
    return `The state is kept as '${name}'`;
  }

  // The state before is kept as well, so that going back can be undone.
  private async goBack(name: string): Promise<string> {
    const before = await this.link.request({ case: "takeSnapshot", value: {} }, "snapshot").catch(() => null);
    await this.link.request({ case: "restoreSnapshot", value: { name } }, "ok");
    const undo = () => void this.link.request({ case: "restoreSnapshot", value: { snapshot: before!.snapshot } }, "ok").catch(reportError);
    report(`The world is back at '${name}'`, "note", before ? { name: "Undo", run: undo } : undefined);
    return "";
  }

  private get names(): string[] {
    try {
      const kept: unknown = JSON.parse(localStorage.getItem(kStored + this.scene) ?? "[]");
      return Array.isArray(kept) ? kept.filter((name): name is string => typeof name === "string") : [];
    } catch {
      return [];
    }
  }

  private keep(names: readonly string[]): void {
    localStorage.setItem(kStored + this.scene, JSON.stringify(names));
    this.show();
  }

  private show(): void {
    this.list.replaceChildren(...this.names.map((name) => h("li", {}, h("span", { class: "menu-name" }, name),
      actButton("Go back", () => this.goBack(name), `Go back to ${name}`),
      iconButton(icons.close, `Forget ${name}`, () => this.keep(this.names.filter((other) => other !== name))))));
  }
}

// Pure.
export function freeName(taken: readonly string[]): string {
  for (let i = taken.length + 1; ; ++i) if (!taken.includes(`bookmark-${i}`)) return `bookmark-${i}`;
}
