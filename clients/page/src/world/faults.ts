// Faults on purpose, by click: what a part can suffer, with its numbers and for how long, and what it suffers
// now.
import type { FaultKind, FaultList } from "../link/messages";
import type { Link } from "../link/link";
import type { Parts } from "../model/parts";
import { poll } from "../model/poll";
import { h, setText } from "../ui/dom";
import { actButton, section } from "./act";

const kLookMs = 500; // while the menu is open

export class FaultsSection {
  readonly element: HTMLElement;
  private readonly active = h("ul", { class: "active-faults" });
  private readonly part = h("select", { "aria-label": "Part to break" });
  private readonly kind = h("select", { "aria-label": "Fault" });
  private readonly effect = h("p", { class: "fault-effect" });
  private readonly numbers = h("div", { class: "fault-numbers" });
  private readonly seconds = h("input", { type: "number", min: 0, step: "any", value: "0", "aria-label": "Duration of the fault in s; 0: until it is ended" });
  private kinds: FaultKind[] = [];
  private shown = ""; // of the active ones

  constructor(private readonly link: Link, private readonly parts: Parts) {
    const forSeconds = h("label", { class: "field" }, h("span", {}, "for s"), this.seconds);
    this.element = section("Faults on purpose", h("div", { class: "menu-row" }, this.part, this.kind), this.effect, this.numbers,
      h("div", { class: "menu-row" }, forSeconds, actButton("Break it", () => this.inject())), this.active);
    this.part.addEventListener("change", () => void this.refresh());
    this.kind.addEventListener("change", () => this.showNumbers());
    // A fault acts from the next tick on, ends by itself, and may be another client's
    poll(() => this.look(), kLookMs);
  }

  // Call it when the menu opens.
  async open(): Promise<void> {
    const before = this.part.value;
    const names = this.parts.list.value.map(({ name }) => name);
    this.part.replaceChildren(...names.map((name) => h("option", { value: name }, name)));
    if (names.includes(before)) this.part.value = before;
    await this.refresh();
  }

  private async inject(): Promise<string> {
    const numbers = [...this.numbers.querySelectorAll("input")].filter((input) => input.value !== "").map((input) => ({ name: input.name, value: input.valueAsNumber }));
    const durationNs = BigInt(Math.round(1e9 * (this.seconds.valueAsNumber || 0)));
    const [part, kind] = [this.part.value, this.kind.value];
    await this.link.request({ case: "injectFault", value: { part, kind, numbers, durationNs } }, "ok");
    await this.refresh();
    return `${part}: ${kind}`;
  }

  private async refresh(): Promise<void> {
    if (this.part.value === "") return;
    const list = await this.link.request({ case: "listFaults", value: { part: this.part.value } }, "faults");
    const before = this.kind.value;
    this.kinds = list.kinds;
    this.kind.replaceChildren(...list.kinds.map(({ name }) => h("option", { value: name }, name)));
    if (list.kinds.some(({ name }) => name === before)) this.kind.value = before;
    this.showNumbers();
    this.showActive(list);
  }

  private async look(): Promise<void> {
    if (!this.element.checkVisibility() || this.part.value === "" || !this.link.mayChangeWorld) return;
    const list = await this.link.request({ case: "listFaults", value: { part: this.part.value } }, "faults").catch(() => null);
    if (list) this.showActive(list);
  }

  private showNumbers(): void {
    const kind = this.kinds.find(({ name }) => name === this.kind.value);
    setText(this.effect, kind?.effect ?? "");
    this.numbers.replaceChildren(...(kind?.numbers ?? []).map(({ name, unit, minimum, maximum, needed, usual }) => {
      const input = h("input", { type: "number", name, min: minimum, max: maximum, step: "any", required: needed, placeholder: needed ? "" : String(usual) });
      // The first drive is as good as any to begin with
      if (needed && minimum >= 1) input.value = String(minimum);
      return h("label", { class: "field" }, h("span", {}, unit === "" ? name : `${name}, ${unit}`), input);
    }));
  }

  private showActive({ active }: FaultList): void {
    const now = active.map(({ part, kind, numbers }) => [part, kind, ...numbers.map(({ name, value }) => `${name} ${value}`)].join()).join(";");
    if (now === this.shown) return; // a button that a user is at stays
    this.shown = now;
    this.active.replaceChildren(...active.map(({ part, kind, numbers }) => {
      const words = [kind, ...numbers.map(({ name, value }) => `${name} ${value}`)].join(", ");
      const joint = numbers.find(({ name }) => name === "joint")?.value ?? 0;
      const end = async () => {
        await this.link.request({ case: "clearFault", value: { part, kind, joint } }, "ok");
        await this.refresh();
        return `${part}: ${kind} has ended`;
      };
      return h("li", {}, h("span", { class: "menu-name" }, words), actButton("End it", end, `End ${words}`));
    }));
  }
}
