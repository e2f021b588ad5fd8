// The keys of the page, on "?", and three steps for a first visit.
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

// Null: this browser has seen it. It goes for good when it is closed.
export function firstSteps(): HTMLElement | null {
  if (localStorage.getItem(kSeen)) return null;
  const steps = ["Press “Take control” below the panel.", "Move a slider, or drag the tool: the tab “Tool”.", "Press a port's plot button to see it over time. “Stop”, or Escape, stops everything."];
  const element = h("section", { class: "first-steps", "aria-label": "First steps" }, h("h2", {}, "Three steps"), h("ol", {}, ...steps.map((step) => h("li", {}, step))),
    h("div", {}, h("button", { type: "button", class: "small", onclick: () => showKeys() }, "Keys (?)"),
      h("button", { type: "button", class: "small primary", onclick: () => (localStorage.setItem(kSeen, "1"), element.remove()) }, "Got it")));
  return element;
}
