// Shared by the sections of the menu "World".
import { h } from "../ui/dom";
import { report, reportError } from "../ui/toasts";

export function section(title: string, ...content: HTMLElement[]): HTMLElement {
  return h("section", { "aria-label": title }, h("h2", {}, title), ...content);
}

// A button that asks the server for something, and tells what became of it. `run` resolves to the words; to
// an empty text where the world itself shows it.
export function actButton(name: string, run: () => Promise<string>, label = name): HTMLButtonElement {
  return h("button", { type: "button", class: "small", "aria-label": label, onclick: () => void run().then((words) => words !== "" && report(words)).catch(reportError) }, name);
}
