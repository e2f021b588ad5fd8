// The pane of panels: choosing one, taking control, editing, saving, loading, sharing.
import { Signal } from "../common/signal";
import type { Parts } from "../model/parts";
import type { World } from "../model/world";
import { h, iconButton, setText } from "../ui/dom";
import { download, pickText } from "../ui/files";
import { icons } from "../ui/icons";
import { fromHash, share } from "../ui/link_text";
import { report, reportError } from "../ui/toasts";
import { emptyPanel, formatPanel, kWidgetTypes, parsePanel, type PanelData, type WidgetType } from "./file";
import { generatedPanel } from "./generate";
import { kKinds } from "./kinds";
import { PanelView } from "./panel_view";
import { settingsForm } from "./settings";

const kPrefix = "#panel=";

export class PanelPane {
  readonly view: PanelView;
  readonly isEmpty = new Signal<boolean>(true); // there is nothing to show, and no panel to choose
  private readonly choice = h("select", { "aria-label": "Panel", class: "panel-choice" });
  private readonly take = h("button", { type: "button", class: "primary take", hidden: true }, "Take control");
  private readonly edit: HTMLButtonElement;
  private readonly tools: HTMLElement;
  private readonly settings = h("div", { class: "panel-settings", hidden: true });
  private panels: PanelData[] = [emptyPanel("Empty panel")];
  private own: PanelData[] = []; // loaded, made or shared by the user; the others are the scene's
  private scene = ""; // what the scene's panels were made of

  constructor(pane: HTMLElement, private readonly parts: Parts, world: World) {
    this.view = new PanelView(this.panels[0]!, parts);
    this.edit = iconButton(icons.edit, "Edit the panel", () => this.setEditing(this.edit.getAttribute("aria-pressed") !== "true"), { "aria-pressed": "false" });
    this.tools = this.makeTools();
    const head = h("div", { class: "pane-head" }, h("h2", {}, "Panel"), this.choice, this.edit,
      iconButton(icons.upload, "Load a panel from a file", () => this.load()),
      iconButton(icons.download, "Save the panel to a file", () => this.save()),
      iconButton(icons.link, "Copy a link to this panel", () => void this.share()));
    pane.append(head, this.tools, this.settings, h("div", { class: "panel-scroll", tabindex: 0, role: "group", "aria-label": "Widgets" }, this.view.element), h("div", { class: "panel-foot" }, this.take));
    this.choice.addEventListener("change", () => this.view.show(this.panels[Number(this.choice.value)]!));
    this.take.addEventListener("click", () => void this.takeControl());
    this.view.onSelect = (data) => this.settings.replaceChildren(...(data ? [settingsForm(data, parts, () => this.view.changed())] : []));
    setInterval(() => this.showTake(), 250);
    world.description.watch((description) => description && this.offer(description.scene, description.panels.map(({ text }) => text)));
    void this.openShared();
  }

  // The panels of this scene take the place of those of another one. The first one is shown, unless the user
  // has one open. A scene without panels gets one of all parts.
  private offer(scene: string, texts: string[]): void {
    const key = JSON.stringify([scene, texts, this.parts.list.value.map(({ name, ports }) => [name, ports.length])]);
    if (key === this.scene) return;
    this.scene = key;
    const brought = texts.flatMap((text) => parsed(text) ?? []);
    const generated = generatedPanel(this.parts.list.value.map(({ description }) => description));
    if (generated.widgets.length > 0) brought.push(generated);
    this.panels = [emptyPanel("Empty panel"), ...brought, ...this.own];
    this.list();
    if (!this.own.includes(this.view.panel)) this.show(brought[0] ?? this.panels[0]!);
    this.isEmpty.value = this.panels.every(({ widgets }) => widgets.length === 0);
  }

  // A panel that the user brings. It is shown until another one is chosen, also of another scene.
  open(panel: PanelData): void {
    this.own.push(panel);
    this.panels.push(panel);
    this.list();
    this.show(panel);
    this.isEmpty.value = false;
  }

  private show(panel: PanelData): void {
    this.view.show(panel);
    this.choice.value = String(this.panels.indexOf(panel));
  }

  private list(): void {
    this.choice.replaceChildren(...this.panels.map(({ name }, i) => h("option", { value: i }, name)));
    this.choice.value = String(this.panels.indexOf(this.view.panel));
  }

  private setEditing(on: boolean): void {
    this.edit.setAttribute("aria-pressed", String(on));
    this.view.setEditing(on);
    this.tools.hidden = this.settings.hidden = !on;
  }

  private makeTools(): HTMLElement {
    const kind = h("select", { "aria-label": "Kind of widget" }, ...kWidgetTypes.map((type) => h("option", { value: type }, kKinds[type].title)));
    const name = h("input", { type: "text", "aria-label": "Name of the panel", placeholder: "Name" });
    name.addEventListener("change", () => ((this.view.panel.name = name.value || "Panel"), this.list()));
    const add = h("button", { type: "button", onclick: () => this.view.onSelect(this.view.add(kind.value as WidgetType, [])) }, "Add");
    return h("div", { class: "panel-tools", hidden: true }, name, kind, add,
      h("p", {}, "Drag ports from the tree to here. Widgets move by pointer or arrow keys, change size with Shift."));
  }

  private showTake(): void {
    const parts = [...this.view.partsToLease()];
    this.take.hidden = parts.length === 0;
    this.take.disabled = !this.parts.mayCommand; // by this role, in a recording, or with the server gone
    setText(this.take, `Take control of ${parts.join(", ")}`);
  }

  private async takeControl(): Promise<void> {
    for (const name of this.view.partsToLease()) await this.parts.find(name)?.acquire().catch(reportError);
  }

  private save(): void {
    download(`${this.view.panel.name}.panel.json`, new Blob([formatPanel(this.view.panel)], { type: "application/json" }));
  }

  private load(): void {
    pickText(".json").then((text) => this.open(parsePanel(text))).catch(reportError);
  }

  private async share(): Promise<void> {
    const copied = await share(kPrefix, formatPanel(this.view.panel));
    report(`The address now holds this panel${copied ? ", and is on the clipboard" : "; copy it from there"}`);
  }

  private async openShared(): Promise<void> {
    try {
      const text = await fromHash(kPrefix, location.hash);
      if (text !== null) this.open(parsePanel(text));
    } catch (error) {
      reportError(error);
    }
  }
}

// A panel of the scene that cannot be read is told, and left out.
function parsed(text: string): PanelData | null {
  try {
    return parsePanel(text);
  } catch (error) {
    reportError(error);
    return null;
  }
}
