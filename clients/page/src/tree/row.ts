// One port in the tree: name, live value, unit, its place in its range, its last seconds, and the buttons to
// act on it.
import type { Port } from "../model/part";
import { h, iconButton, setText } from "../ui/dom";
import { icons } from "../ui/icons";
import { formatOf, formatValue, inDegrees, inWords, share } from "../ui/numbers";
import { toneOf } from "../ui/tone";
import { startPortDrag } from "../ui/drag";
import { leastSpan } from "../ui/range";
import { report } from "../ui/toasts";
import { editorFor, type Editor } from "./editor";
import { Sparkline } from "./sparkline";

export interface RowActions {
  plot(ports: Port[]): void;
}

export class PortRow {
  readonly element: HTMLElement;
  visible = false; // on the screen, by the tree's observer
  private readonly value = h("span", { class: "value" });
  private readonly bar = h("span", { class: "range-fill" });
  private readonly spark: Sparkline;
  private readonly editorPlace = h("div", { class: "editor-place" });
  private readonly hold: HTMLButtonElement | null;
  private editor: Editor | null = null;
  private last = NaN;

  constructor(readonly port: Port, label: string, actions: RowActions) {
    const { name, unit, minimum, maximum } = port.description;
    const isInput = port.side === "input";
    this.spark = new Sparkline(leastSpan(port.description));
    this.hold = isInput ? iconButton(icons.pin, `Hold ${name}`, () => this.toggleHold(), { "aria-pressed": "false" }) : null;
    this.element = h(
      "div",
      { class: unit === "" ? "port unitless" : "port", draggable: true, "data-port": name, title: `${name}: ${formatValue(minimum)} to ${formatValue(maximum)} ${unit}` },
      h("span", { class: "name" }, label),
      this.value,
      h("span", { class: "unit" }, unit),
      this.spark.canvas,
      h("span", { class: "row-actions" }, this.hold, iconButton(icons.plot, `Plot ${name}`, () => actions.plot([port]))),
      h("span", { class: "range", "aria-hidden": "true" }, this.bar),
      this.editorPlace,
    );
    if (this.hold) this.hold.hidden = true;
    this.element.addEventListener("dragstart", (event) => startPortDrag(event, [port]));
  }

  matches(words: string[]): boolean {
    const text = `${this.port.part.name} ${this.port.description.name} ${this.port.description.unit}`.toLowerCase();
    return words.every((word) => text.includes(word));
  }

  setEditable(on: boolean): void {
    if (this.port.side !== "input" || on === (this.editor !== null)) return;
    this.editor = on ? editorFor(this.port) : null;
    // Also while the row is out of sight, and update() draws nothing
    this.editor?.show(this.port.part.value(this.port));
    this.editorPlace.replaceChildren(...(this.editor ? [this.editor.element] : []));
    this.element.draggable = !on; // dragging an editor must not drag the row
    if (this.hold) this.hold.hidden = !on;
    this.element.classList.toggle("editable", on);
    this.last = NaN;
  }

  update(): void {
    const value = this.port.part.value(this.port);
    this.spark.add(value);
    this.showHold();
    if (!this.visible) return;
    this.spark.draw();
    if (Object.is(value, this.last)) return;
    this.last = value;
    const { unit, minimum, maximum } = this.port.description;
    const words = inWords(this.port.description, value);
    setText(this.value, formatOf(this.port.description, value));
    this.value.dataset["tone"] = toneOf(words);
    this.value.title = words || inDegrees(value, unit);
    this.bar.style.transform = `scaleX(${share(value, minimum, maximum).toFixed(4)})`;
    this.editor?.show(value);
  }

  private toggleHold(): void {
    const { held } = this.port.part;
    if (held.has(this.port.index)) held.delete(this.port.index);
    else {
      const value = this.port.part.value(this.port);
      held.set(this.port.index, value);
      report(`${this.port.description.name} is held at ${formatOf(this.port.description, value)}`);
    }
    this.showHold();
  }

  private showHold(): void {
    if (!this.hold) return;
    const held = String(this.port.part.held.has(this.port.index));
    if (this.hold.getAttribute("aria-pressed") !== held) this.hold.setAttribute("aria-pressed", held);
  }
}
