// A part's parameters with typed editors. They are read when their list is opened, and after each change.
import type { Link } from "../link/link";
import type { ParameterDescription, ParameterValue } from "../link/messages";
import type { Part } from "../model/part";
import { h } from "../ui/dom";
import { reportError } from "../ui/toasts";

type Value = ParameterValue["value"];

export interface ParametersView {
  element: HTMLElement;
  filter(words: string[]): boolean; // shows those that match all words, and returns whether any does
}

export function parametersView(link: Link, part: Part): ParametersView | null {
  const count = part.description.parameters.length;
  if (count === 0) return null;
  const body = h("div", { class: "parameters" });
  const details = h("details", { class: "side" }, h("summary", {}, h("span", {}, "Parameters"), h("span", { class: "count" }, String(count))), body);
  let words: string[] = [];
  let openBefore: boolean | null = null; // during a search: whether the list was open before it
  const matches = ({ name, help, unit }: ParameterDescription) => words.every((word) => `${part.name} ${name} ${help} ${unit}`.toLowerCase().includes(word));
  const refresh = async () => {
    const { parameters } = await link.request({ case: "getParameters", value: { part: part.name } }, "parameters");
    body.replaceChildren(...parameters.filter(matches).map((parameter) => row({ ...parameter, readOnly: parameter.readOnly || link.recorded.value }, set)));
  };
  const set = (name: string, value: Value) =>
    link.request({ case: "setParameter", value: { part: part.name, name, value: { value: value as never } } }, "ok")
      .catch(reportError)
      .then(refresh)
      .catch(reportError);
  details.addEventListener("toggle", () => details.open && refresh().catch(reportError));
  const filter = (wanted: string[]) => {
    words = wanted;
    const found = part.description.parameters.some(matches);
    details.hidden = !found;
    if (words.length > 0) openBefore ??= details.open;
    const open = words.length > 0 ? found : (openBefore ?? details.open);
    if (words.length === 0) openBefore = null;
    if (open && details.open) refresh().catch(reportError); // else its toggle event does
    details.open = open;
    return found && words.length > 0;
  };
  return { element: details, filter };
}

function row(parameter: ParameterDescription, set: (name: string, value: Value) => void): HTMLElement {
  const editor = editorFor(parameter, (value) => set(parameter.name, value));
  return h("label", { class: "parameter", title: parameter.help }, h("span", { class: "name" }, parameter.name), editor, h("span", { class: "unit" }, parameter.unit));
}

function editorFor(parameter: ParameterDescription, set: (value: Value) => void): HTMLElement {
  const value: Value = parameter.value?.value ?? { case: undefined };
  const disabled = parameter.readOnly;
  if (value.case === "flag") {
    const box = h("input", { type: "checkbox", checked: value.value, disabled });
    box.addEventListener("change", () => set({ case: "flag", value: box.checked }));
    return box;
  }
  if (value.case === "text") return textEditor(parameter, value.value, (text) => set({ case: "text", value: text }));
  const limits = parameter.maximum > parameter.minimum ? { min: parameter.minimum, max: parameter.maximum } : {};
  const shown = value.case === undefined ? "" : String(value.value);
  const box = h("input", { type: "number", value: shown, step: value.case === "integer" ? 1 : "any", disabled, ...limits });
  box.addEventListener("change", () => {
    const typed = value.case === "integer" ? Math.round(box.valueAsNumber) : box.valueAsNumber;
    const usable = value.case === "integer" ? Number.isSafeInteger(typed) : Number.isFinite(typed);
    if (!usable) {
      if (box.value !== "") reportError(new Error(`'${parameter.name}': whole numbers beyond ${Number.MAX_SAFE_INTEGER} cannot be sent from here`));
      box.value = shown;
    } else if (value.case === "integer") set({ case: "integer", value: BigInt(typed) });
    else set({ case: "number", value: typed });
  });
  return box;
}

function textEditor(parameter: ParameterDescription, text: string, set: (text: string) => void): HTMLElement {
  const disabled = parameter.readOnly;
  const box = parameter.choices.length > 0
    ? h("select", { disabled }, ...parameter.choices.map((choice) => h("option", { selected: choice === text }, choice)))
    : h("input", { type: "text", value: text, disabled });
  box.addEventListener("change", () => set(box.value));
  return box;
}
