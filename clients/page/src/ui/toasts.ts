// Short messages at the lower edge: what was done, and what went wrong. A message may offer one action.
import { LostError } from "../link/messages";
import { h } from "./dom";

const kShownMs = 5000;
const kOfferedMs = 30_000; // with an action
const kMost = 4;
const place = h("div", { class: "toasts", role: "status", "aria-live": "polite" });

export interface Action {
  name: string;
  run: () => void;
}

export function report(text: string, kind: "note" | "error" = "note", action?: Action): void {
  if (!place.isConnected) document.body.append(place);
  const last = place.lastElementChild as HTMLElement | null;
  // The same message again replaces the old one, unless that offers more
  if (last?.dataset["text"] === text && !action && last.dataset["offers"]) return;
  if (last?.dataset["text"] === text) last.remove();
  const toast = h("div", { class: `toast ${kind}` }, text);
  toast.dataset["text"] = text;
  if (action) toast.dataset["offers"] = action.name;
  if (action) toast.append(h("button", { type: "button", class: "small", onclick: () => (toast.remove(), action.run()) }, action.name));
  place.append(toast);
  while (place.children.length > kMost) place.firstElementChild?.remove();
  setTimeout(() => toast.remove(), action ? kOfferedMs : kShownMs);
}

// Shows a text of the server as a sentence of its own.
export function reportTold(text: string, kind: "note" | "error" = "note"): void {
  report(text.charAt(0).toUpperCase() + text.slice(1), kind);
}

// For the catch of a promise: shows the server's own text. A lost connection has its own sign.
export function reportError(error: unknown): void {
  if (error instanceof LostError) return;
  report(error instanceof Error ? error.message : String(error), "error");
}
