// Asks the user before something is done that others would notice. Resolves to true if the user agrees.
import { h } from "./dom";

export function ask(question: string, yes: string): Promise<boolean> {
  const agree = h("button", { type: "submit", value: "yes", class: "primary" }, yes);
  const cancel = h("button", { type: "submit", value: "no", formNoValidate: true }, "Cancel");
  const dialog = h("dialog", { class: "ask", "aria-label": question }, h("p", {}, question), h("form", { method: "dialog" }, cancel, agree));
  document.body.append(dialog);
  dialog.showModal();
  cancel.focus(); // agreeing needs a second thought
  return new Promise((resolve) =>
    dialog.addEventListener("close", () => {
      dialog.remove();
      resolve(dialog.returnValue === "yes");
    }));
}
