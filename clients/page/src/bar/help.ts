// The keys of the page, on "?", and the first steps for a first visit.
import type { Part, Port } from "../model/part";
import type { Parts } from "../model/parts";
import { kDesired } from "../model/desired";
import { h } from "../ui/dom";

const kKeys: [string, string][] = [
  ["Escape", "stops all parts at once (closes a menu first)"],
  ["Space", "runs or pauses the world"],
  ["?", "shows these keys"],
  ["Arrow keys", "in the view: orbit; with Shift: pan"],
  ["+ and −", "in the view: zoom"],
  ["Home", "in the view: shows all of the world"],
  ["Ctrl and drag", "in the view: pulls a body"],
];
const kSeen = "visum.hint";

export function showKeys(): void {
  if (document.querySelector("dialog.keys")) return;
  const close = h("button", { type: "submit", class: "primary" }, "Close");
  const rows = kKeys.flatMap(([key, does]) => [h("dt", {}, h("kbd", {}, key)), h("dd", {}, does)]);
  const dialog = h("dialog", { class: "ask keys", "aria-label": "Keys" }, h("h2", {}, "Keys"), h("dl", {}, ...rows), h("form", { method: "dialog" }, close));
  dialog.addEventListener("close", () => dialog.remove());
  document.body.append(dialog);
  dialog.showModal();
}

// Null: this browser has seen it. It goes for good when it is closed. On a small screen it is folded, so as
// not to hide what it speaks of.
export function firstSteps(parts: Parts): HTMLElement | null {
  if (localStorage.getItem(kSeen)) return null;
  const steps = h("ol", {});
  const element = h("section", { class: "first-steps folded", "aria-label": "First steps" }, h("h2", {}, "First steps"), steps,
    h("div", {}, h("button", { type: "button", class: "small unfold", onclick: () => element.classList.remove("folded") }, "First steps"),
      h("button", { type: "button", class: "small", onclick: () => showKeys() }, "Keys (?)"),
      h("button", { type: "button", class: "small primary", onclick: () => (localStorage.setItem(kSeen, "1"), element.remove()) }, "Got it")));
  parts.list.watch((list) => steps.replaceChildren(...stepsFor(list).map((step) => h("li", {}, step))));
  return element;
}

// The steps fit a world with these parts.
function stepsFor(list: readonly Part[]): string[] {
  const has = (test: (port: Port) => boolean) => list.some(({ ports }) => ports.some(test));
  const hasTool = has(({ description }) => kDesired.test(description.group));
  const first = has(({ side }) => side === "input")
    ? ["Press “Take control” below the panel.", hasTool ? "Move a slider, or drag the tool: the tab “Tool”." : "Move a slider."]
    : ["Drag to look around.", "Click a body to see its motion; pull it with Ctrl and drag."];
  const plot = has(() => true) ? "Press a port's plot button to see it over time. " : "";
  return [...first, `${plot}“Stop”, or Escape, stops everything.`];
}
