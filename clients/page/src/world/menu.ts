// The menu "World": what a user does to it. Bookmarks of its state, a recording, models and bodies that come
// and go, faults on purpose, and what a reset takes back. A section has an element, and a function `open` if
// it asks the server for something when the menu opens.
import { ResetScope } from "../link/messages";
import type { Link } from "../link/link";
import type { Events } from "../model/events";
import type { Parts } from "../model/parts";
import type { World } from "../model/world";
import { h } from "../ui/dom";
import { popover } from "../ui/popover";
import { reportError } from "../ui/toasts";
import { section } from "./act";
import { BodiesSection } from "./bodies";
import { BookmarksSection } from "./bookmarks";
import { FaultsSection } from "./faults";
import { ModelsSection } from "./models";
import { RecordingSection } from "./recording";

const kScopes: [string, ResetScope][] = [
  ["time and state", ResetScope.WORLD], ["state alone", ResetScope.STATE], ["time alone", ResetScope.TIME],
  ["what came or went", ResetScope.SPAWNED], ["all of it", ResetScope.ALL],
];

export class WorldMenu {
  readonly element: HTMLDetailsElement;

  constructor(link: Link, world: World, parts: Parts, events: Events, private readonly reset: (scope: ResetScope) => void) {
    const bookmarks = new BookmarksSection(link, world);
    const faults = new FaultsSection(link, parts);
    const models = new ModelsSection(link, world);
    const content = h("div", { class: "world-menu" }, bookmarks.element, new RecordingSection(link, events).element, models.element, new BodiesSection(link, world).element, faults.element, this.resets());
    this.element = popover("World", content);
    this.element.classList.add("world");
    this.element.addEventListener("toggle", () => this.element.open && void Promise.all([faults.open(), models.open()]).catch(reportError));
    const show = () => (this.element.hidden = !link.mayChangeWorld);
    link.state.watch(show);
    link.recorded.watch(show);
  }

  private resets(): HTMLElement {
    const scope = h("select", { "aria-label": "What the reset takes back" }, ...kScopes.map(([name, value]) => h("option", { value }, name)));
    const press = h("button", { type: "button", class: "small", onclick: () => this.reset(Number(scope.value)) }, "Reset this");
    return section("Reset", h("div", { class: "menu-row" }, scope, press));
  }
}
