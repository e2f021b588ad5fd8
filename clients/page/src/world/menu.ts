// The menu "World": what a user does to it. Another scene, scenarios beside it, bookmarks of its state, a
// recording, models and bodies that come and go, faults on purpose, and what a reset takes back. A section
// has an element, and a function `open` or `show` if it needs something of the server when the menu opens.
// All this needs the role admin. Others see which scenes and scenarios there are, how a scenario fares, and
// why they may do no more.
import { ResetScope } from "../link/messages";
import type { Link } from "../link/link";
import type { Clock } from "../model/clock";
import type { Events } from "../model/events";
import type { Parts } from "../model/parts";
import type { World } from "../model/world";
import { h } from "../ui/dom";
import { popover } from "../ui/popover";
import { reportError } from "../ui/toasts";
import { roleChoice } from "../bar/role";
import { section } from "./act";
import { BodiesSection } from "./bodies";
import { BookmarksSection } from "./bookmarks";
import { FaultsSection } from "./faults";
import { ModelsSection } from "./models";
import { RecordingSection } from "./recording";
import { ScenariosSection } from "./scenarios";
import { ScenesSection } from "./scenes";

const kScopes: [string, ResetScope][] = [
  ["time and state", ResetScope.WORLD], ["state alone", ResetScope.STATE], ["time alone", ResetScope.TIME],
  ["what came or went", ResetScope.SPAWNED], ["all of it", ResetScope.ALL],
];

export class WorldMenu {
  readonly element: HTMLDetailsElement;
  private readonly scenes: ScenesSection;
  private readonly scenarios: ScenariosSection;
  private readonly faults: FaultsSection;
  private readonly models: ModelsSection;

  constructor(private readonly link: Link, world: World, parts: Parts, clock: Clock, events: Events, private readonly reset: (scope: ResetScope) => void) {
    this.scenes = new ScenesSection(link, world, parts, clock);
    this.scenarios = new ScenariosSection(link);
    this.faults = new FaultsSection(link, parts);
    this.models = new ModelsSection(link, world);
    const why = h("p", { class: "menu-note", role: "note" }, "Only an administrator changes the world. Choose the role Admin, if the server lets you.");
    const changes = h("div", { class: "world-menu" }, new BookmarksSection(link, world).element, new RecordingSection(link, events).element, this.models.element, new BodiesSection(link, world).element, this.faults.element, this.resets());
    this.element = popover("World", h("div", { class: "world-menu" }, h("label", { class: "menu-role" }, "Role of this page", roleChoice(link, parts)), why, this.scenes.element, this.scenarios.element, changes));
    this.element.classList.add("world");
    this.element.addEventListener("toggle", () => this.open());
    const show = () => {
      this.element.hidden = link.welcome === null || link.recorded.value;
      why.hidden = link.mayChangeWorld;
      changes.hidden = !link.mayChangeWorld;
      this.open();
    };
    link.state.watch(show);
    link.recorded.watch(show);
  }

  private open(): void {
    if (!this.element.open || !this.link.welcome || this.element.hidden) return;
    const asked = [this.offer()];
    if (this.link.mayChangeWorld) asked.push(this.faults.open(), this.models.open());
    void Promise.all(asked).catch(reportError);
  }

  private async offer(): Promise<void> {
    const { scenes, scenarios } = await this.link.request({ case: "listScenes", value: {} }, "scenes");
    this.scenes.show(scenes);
    this.scenarios.show(scenarios);
  }

  private resets(): HTMLElement {
    const scope = h("select", { "aria-label": "What the reset takes back" }, ...kScopes.map(([name, value]) => h("option", { value }, name)));
    const press = h("button", { type: "button", class: "small", onclick: () => this.reset(Number(scope.value)) }, "Reset this");
    return section("Reset", h("div", { class: "menu-row" }, scope, press));
  }
}
