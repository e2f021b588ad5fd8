// A row of parts, each with its state in words, the reason where it is in fault, and the button that ends
// that state.
import type { Link } from "../link/link";
import type { Part } from "../model/part";
import { PartWatch, type PartState } from "./part_state";
import type { Parts } from "../model/parts";
import { h, setText } from "../ui/dom";
import { reportError } from "../ui/toasts";

export class PartStrip {
  readonly element = h("section", { class: "strip", "aria-label": "States of the parts" });
  watches: PartWatch[] = [];
  private stops: (() => void)[] = [];

  constructor(private readonly link: Link, parts: Parts) {
    parts.list.watch((list) => this.show(list.filter((part) => part.description.controllerInputs.length > 0)));
    link.state.watch(({ kind }) => (this.element.dataset["stale"] = String(kind !== "open")));
  }

  private show(list: Part[]): void {
    if (list.length === this.watches.length && list.every((part, i) => part === this.watches[i]?.part)) return;
    for (const stop of this.stops) stop();
    for (const watch of this.watches) watch.dispose();
    this.watches = list.map((part) => new PartWatch(this.link, part));
    this.stops = [];
    this.element.hidden = list.length === 0;
    this.element.replaceChildren(...this.watches.map((watch) => this.chip(watch)));
  }

  private chip(watch: PartWatch): HTMLElement {
    const { part } = watch;
    const words = h("span", { class: "chip-words" });
    const reason = h("span", { class: "chip-reason" });
    const way = h("button", { type: "button", class: "small", hidden: true, onclick: () => void leave(watch).catch(reportError) });
    const element = h("div", { class: "chip", role: "status", "aria-label": `State of ${part.name}` }, h("span", { class: "chip-name" }, part.name), words, reason, way);
    const show = () => {
      const state = watch.state.value;
      element.dataset["tone"] = state.tone;
      setText(words, state.words || leaseWords(part));
      setText(reason, state.reason);
      reason.title = state.reason;
      const name = wayName(watch, state);
      way.hidden = name === "" || this.link.recorded.value;
      setText(way, name);
      const taken = !part.leased.value && part.holder.value !== "" && !state.stopped;
      way.disabled = !this.link.mayCommand || taken;
      way.title = taken ? `'${part.holder.value}' holds the lease of ${part.name}` : "";
    };
    this.stops.push(watch.state.watch(show), part.holder.watch(show), part.leased.watch(show), this.link.state.watch(show), this.link.recorded.watch(show));
    return element;
  }
}

function wayName(watch: PartWatch, state: PartState): string {
  if (state.stopped) return "Release stop";
  const name = watch.wayOut?.description.name ?? "";
  return watch.needsSupplyOff ? `Supply off and on, ${name}` : name;
}

function leaseWords(part: Part): string {
  if (part.leased.value) return "commanded by this page";
  return part.holder.value === "" ? "free" : `commanded by ${part.holder.value}`;
}

// Takes the lease where it is free, because a user who presses the button wants just that.
async function leave(watch: PartWatch): Promise<void> {
  if (watch.state.value.stopped) return watch.press(false);
  if (watch.wayOut && !watch.part.leased.value) await watch.part.acquire();
  await watch.end();
}
