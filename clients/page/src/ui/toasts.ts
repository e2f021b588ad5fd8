// Short messages at the lower edge: what was done, and what went wrong.
import { LostError } from "../link/messages";
import { h } from "./dom";

const kShownMs = 5000;
const kMost = 4;
const place = h("div", { class: "toasts", role: "status", "aria-live": "polite" });

export function report(text: string, kind: "note" | "error" = "note"): void {
  if (!place.isConnected) document.body.append(place);
  const last = place.lastElementChild;
  if (last?.textContent === text) last.remove(); // the same message again replaces the old one
  const toast = h("div", { class: `toast ${kind}` }, text);
  place.append(toast);
  while (place.children.length > kMost) place.firstElementChild?.remove();
  setTimeout(() => toast.remove(), kShownMs);
}

// For the catch of a promise: shows the server's own text. A lost connection has its own sign.
export function reportError(error: unknown): void {
  if (error instanceof LostError) return;
  report(error instanceof Error ? error.message : String(error), "error");
}
