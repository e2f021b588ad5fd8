// A panel for a world whose scene brings none: what commands a part, and what tells its state. Pure.
import type { PartDescription, PortDescription } from "../link/messages";
import { niceStep } from "../ui/numbers";
import { freePlace, kMostRows, kMostWidgets, type PanelData, type WidgetData, type WidgetType } from "./file";

const kReadings = 6; // ports of a part that only measures

export function generatedPanel(parts: readonly Pick<PartDescription, "name" | "controllerInputs" | "sensorOutputs">[]): PanelData {
  const panel: PanelData = { visum_panel: 1, name: "All parts", widgets: [] };
  for (const part of parts) {
    const ports = part.controllerInputs.length > 0 ? commands(part.name, part.controllerInputs, part.sensorOutputs) : readings(part.name, part.sensorOutputs);
    if (ports.length > 0) for (const widget of [label(part.name), ...ports]) add(panel, widget);
  }
  return panel;
}

type Sized = Omit<WidgetData, "x" | "y">;

function add(panel: PanelData, widget: Sized): void {
  const place = widget.w === 12 ? { x: 0, y: Math.max(0, ...panel.widgets.map(({ y, h }) => y + h)) } : freePlace(panel.widgets, widget.w, widget.h);
  if (panel.widgets.length < kMostWidgets && place.y + widget.h <= kMostRows) panel.widgets.push({ ...widget, ...place });
}

const label = (name: string): Sized => ({ type: "label", label: name, w: 12, h: 1, ports: [] });

function commands(part: string, inputs: readonly PortDescription[], outputs: readonly PortDescription[]): Sized[] {
  // A limit of speed is set once, if at all: the sliders are for what moves
  const shown = inputs.filter(({ group, unit }) => !(unit !== "" && /^Maximum /.test(group)));
  const sliders = shown.filter((port) => !isCounter(port) && !isSwitch(port)).map((port) => slider(part, port, outputs));
  const buttons = shown.filter(isCounter).map((port) => small("button", part, port, 4));
  const switches = shown.filter(isSwitch).map((port) => small("radio", part, port, 6));
  const states = outputs.filter(({ values }) => values.length > 0).map((port) => small("lcd", part, port, 6));
  return [...sliders, ...buttons, ...switches, ...states];
}

function readings(part: string, outputs: readonly PortDescription[]): Sized[] {
  return outputs.filter(({ name }) => name !== "Changed").slice(0, kReadings).map((port) => (port.unit === "" ? small("lcd", part, port, 6) : small("bar", part, port, 12)));
}

const isSwitch = ({ unit, minimum, maximum }: PortDescription) => unit === "" && minimum === 0 && maximum === 1;
const isCounter = ({ unit, minimum, maximum }: PortDescription) => unit === "" && minimum === 0 && maximum > 1;

function slider(part: string, port: PortDescription, outputs: readonly PortDescription[]): Sized {
  const actual = outputs.find(({ name }) => name === port.name.replace(/^Desired /, "Actual "));
  return {
    type: "slider", label: port.name, w: 12, h: 2, ports: [{ part, port: port.name }], jog: 20 * niceStep(port.minimum, port.maximum),
    ...(actual ? { actual: { part, port: actual.name } } : {}),
  };
}

function small(type: WidgetType, part: string, port: PortDescription, w: number): Sized {
  return { type, label: port.name, w, h: 2, ports: [{ part, port: port.name }] };
}
