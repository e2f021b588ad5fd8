// Editors for controller inputs: a switch for values of 0 or 1, a button for a counter, a slider with a
// number for all others.
import type { Port } from "../model/part";
import { h } from "../ui/dom";
import { fieldText, formatEnd, niceStep } from "../ui/numbers";
import { reportError } from "../ui/toasts";

export interface Editor {
  element: HTMLElement;
  show(value: number): void; // the value in force
}

export type EditorKind = "switch" | "counter" | "number";

export function editorKind(port: Port): EditorKind {
  const { unit, minimum, maximum } = port.description;
  if (unit !== "" || minimum !== 0) return "number";
  return maximum === 1 ? "switch" : "counter";
}

export function writePort(port: Port, value: number): void {
  port.part.write(port, value).catch(reportError);
}

export function editorFor(port: Port): Editor {
  switch (editorKind(port)) {
    case "switch":
      return switchEditor(port);
    case "counter":
      return counterEditor(port);
    default:
      return numberEditor(port);
  }
}

function switchEditor(port: Port): Editor {
  const box = h("input", { type: "checkbox", role: "switch", "aria-label": port.description.name });
  box.addEventListener("change", () => writePort(port, box.checked ? 1 : 0));
  return { element: h("label", { class: "switch" }, box, h("span", {}, "on")), show: (value) => (box.checked = value !== 0) };
}

// A counter acts when it changes.
function counterEditor(port: Port): Editor {
  const { name } = port.description;
  const element = h("button", { type: "button", class: "small", "aria-label": `Trigger ${name}` }, "Trigger");
  element.addEventListener("click", () => writePort(port, port.part.commanded(port) + 1));
  return { element, show: () => undefined };
}

function numberEditor(port: Port): Editor {
  const { name, unit } = port.description;
  const { minimum, maximum } = port.part.limits(port);
  const step = niceStep(minimum, maximum);
  const range = `${formatEnd(minimum)} to ${formatEnd(maximum)} ${unit}`;
  const slider = h("input", { type: "range", min: minimum, max: maximum, step: "any", "aria-label": `${name}, slider`, title: range });
  const number = h("input", { type: "number", min: minimum, max: maximum, step, "aria-label": `${name} in ${unit || "units"}` });
  let touched = 0;
  const touch = () => (touched = performance.now());
  slider.addEventListener("input", () => {
    touch();
    number.value = fieldText(Number(slider.value), minimum, maximum);
    writePort(port, Number(slider.value));
  });
  number.addEventListener("input", touch);
  number.addEventListener("change", () => {
    touch();
    if (number.value.trim() === "" || !Number.isFinite(number.valueAsNumber)) return;
    slider.value = number.value;
    writePort(port, number.valueAsNumber);
  });
  // Shows the value in force, except while the user is about to change it.
  const show = (value: number) => {
    if (performance.now() - touched < 600 || Number.isNaN(value)) return;
    if (document.activeElement !== number) number.value = fieldText(value, minimum, maximum);
    if (document.activeElement !== slider || Number(slider.value) !== value) slider.value = String(value);
  };
  return { element: h("div", { class: "number-editor" }, slider, number), show };
}
