// The settings of a widget while the panel is edited.
import type { Parts } from "../model/parts";
import { nameOf } from "../ui/drag";
import { h } from "../ui/dom";
import { kMostPorts, type WidgetData } from "./file";
import { kKinds } from "./kinds";

type NumberKey = "minimum" | "maximum" | "jog" | "value" | "release" | "threshold" | "bit" | "seconds";

const kNumbers: Partial<Record<WidgetData["type"], NumberKey[]>> = {
  slider: ["minimum", "maximum", "jog"], number: ["minimum", "maximum"], stick: ["minimum", "maximum"],
  bar: ["minimum", "maximum"], gauge: ["minimum", "maximum"], button: ["value", "release"], led: ["threshold", "bit"], scope: ["seconds"],
};
const kTitles: Record<NumberKey, string> = {
  minimum: "Least", maximum: "Greatest", jog: "Jog step", value: "Pressed", release: "Released", threshold: "Threshold", bit: "Bit", seconds: "Seconds",
};

export function settingsForm(data: WidgetData, parts: Parts, changed: () => void): HTMLElement {
  const label = h("input", { type: "text", value: data.label });
  label.addEventListener("change", () => ((data.label = label.value), changed()));
  const port = portChoice(data, parts, changed);
  return h("fieldset", {}, h("legend", {}, kKinds[data.type].title),
    field("Label", label), port && field("Port", port),
    ...(kNumbers[data.type] ?? []).map((key) => field(kTitles[key], numberInput(data, key, changed))),
    data.type === "button" ? field("Acts as", modeChoice(data, changed)) : null);
}

function field(name: string, input: HTMLElement): HTMLElement {
  return h("label", { class: "field" }, h("span", {}, name), input);
}

function numberInput(data: WidgetData, key: NumberKey, changed: () => void): HTMLElement {
  const input = h("input", { type: "number", step: "any", value: data[key] === undefined ? "" : String(data[key]) });
  input.addEventListener("change", () => {
    if (Number.isFinite(input.valueAsNumber)) data[key] = input.valueAsNumber;
    else delete data[key];
    changed();
  });
  return input;
}

function modeChoice(data: WidgetData, changed: () => void): HTMLElement {
  const choice = h("select", {}, h("option", { value: "counter" }, "counter"), h("option", { value: "value" }, "value"));
  choice.value = data.mode ?? "counter";
  choice.addEventListener("change", () => ((data.mode = choice.value as "counter" | "value"), changed()));
  return choice;
}

function portChoice(data: WidgetData, parts: Parts, changed: () => void): HTMLElement | null {
  if (data.type === "label") return null;
  const several = data.type === "scope" || data.type === "stick" || data.type === "slider";
  const inputsOnly = kKinds[data.type].commands && data.type !== "bits";
  const ports = parts.list.value.flatMap((part) => part.ports).filter((port) => !inputsOnly || port.side === "input");
  const choice = h("select", { multiple: several, size: several ? 4 : 1 }, several ? null : h("option", { value: "" }, "none"),
    ...ports.map((port, i) => h("option", { value: i, selected: data.ports.some(({ part, port: name }) => part === port.part.name && name === port.description.name) }, `${port.part.name} · ${port.description.name}`)));
  choice.addEventListener("change", () => {
    data.ports = [...choice.selectedOptions].filter((option) => option.value !== "").slice(0, kMostPorts).map((option) => nameOf(ports[Number(option.value)]!));
    changed();
  });
  return choice;
}
