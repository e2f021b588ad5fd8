// A button that opens a box; Escape or a click elsewhere closes it. A click into a dialog, which the box may
// have opened, does not.
import { h, svg } from "./dom";

// `icon`: a path, shown instead of the name.
export function popover(name: string, content: HTMLElement, icon?: string): HTMLDetailsElement {
  const summary = h("summary", { class: icon ? "icon" : "worded", title: name, "aria-label": name, role: "button" }, icon ? svg(icon) : name);
  const details = h("details", { class: "popover" }, summary, h("div", { class: "popover-body" }, h("h2", {}, name), content));
  document.addEventListener("pointerdown", ({ target }) => {
    if (!details.contains(target as Node) && !(target as Element).closest("dialog")) details.open = false;
  });
  document.addEventListener("keydown", (event) => {
    if (event.key !== "Escape" || !details.open || (event.target as Element).closest("dialog")) return;
    details.open = false;
    summary.focus();
  });
  return details;
}
