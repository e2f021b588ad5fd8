// Tabs in one place: a row of buttons, of which one shows its content.
import { h } from "./dom";

export interface Tab {
  name: string;
  content: HTMLElement;
}

export function tabs(label: string, list: readonly Tab[]): HTMLElement {
  const buttons = list.map(({ name, content }, i) => {
    content.id = `tab-${name.toLowerCase()}`;
    content.setAttribute("role", "tabpanel");
    content.setAttribute("aria-label", name);
    return h("button", { type: "button", role: "tab", class: "tab", "aria-controls": content.id, onclick: () => show(i) }, name);
  });
  const show = (chosen: number) => {
    buttons.forEach((button, i) => {
      button.setAttribute("aria-selected", String(i === chosen));
      button.tabIndex = i === chosen ? 0 : -1;
      list[i]!.content.hidden = i !== chosen;
    });
  };
  const row = h("div", { class: "tabs", role: "tablist", "aria-label": label }, ...buttons);
  row.addEventListener("keydown", ({ key }) => {
    const step = key === "ArrowRight" ? 1 : key === "ArrowLeft" ? -1 : 0;
    const at = buttons.indexOf(document.activeElement as HTMLButtonElement);
    if (step === 0 || at < 0) return;
    const next = (at + step + buttons.length) % buttons.length;
    show(next);
    buttons[next]!.focus();
  });
  show(0);
  return row;
}
