// The kinds of widgets, and the settings of a new widget of each kind.
import type { Port } from "../model/part";
import { nameOf } from "../ui/drag";
import { niceStep } from "../ui/numbers";
import { bits, button, number, radio, slider } from "./controls";
import type { WidgetData, WidgetType } from "./file";
import { bar, gauge, label, lcd, led } from "./indicators";
import { scope } from "./scope";
import { stick } from "./stick";
import type { Context, Widget } from "./widget";

export interface Kind {
  title: string;
  make(context: Context): Widget;
  commands: boolean; // needs the lease
  size: [number, number];
}

export const kKinds: Record<WidgetType, Kind> = {
  slider: { title: "Slider", make: slider, commands: true, size: [12, 2] },
  number: { title: "Value input", make: number, commands: true, size: [6, 2] },
  button: { title: "Push button", make: button, commands: true, size: [4, 2] },
  radio: { title: "Radio buttons", make: radio, commands: true, size: [6, 2] },
  stick: { title: "Stick", make: stick, commands: true, size: [6, 6] },
  bits: { title: "Bit selector", make: bits, commands: true, size: [6, 5] },
  led: { title: "LED", make: led, commands: false, size: [3, 2] },
  lcd: { title: "LCD", make: lcd, commands: false, size: [6, 2] },
  bar: { title: "Bar", make: bar, commands: false, size: [12, 2] },
  gauge: { title: "Gauge", make: gauge, commands: false, size: [6, 5] },
  scope: { title: "Oscilloscope", make: scope, commands: false, size: [12, 6] },
  label: { title: "Label", make: label, commands: false, size: [12, 1] },
};

// The widget that a port becomes when it is dropped on a panel.
export function usualType(port: Port): WidgetType {
  const { unit, minimum, maximum } = port.description;
  if (port.side === "output") return unit === "" ? "lcd" : "bar";
  if (unit !== "" || minimum !== 0) return "slider";
  return maximum === 1 ? "radio" : "button";
}

export function newWidget(type: WidgetType, ports: readonly Port[], place: { x: number; y: number }): WidgetData {
  const [w, h] = kKinds[type].size;
  const first = ports[0];
  const data: WidgetData = { type, label: first?.description.name ?? kKinds[type].title, ...place, w, h, ports: ports.map(nameOf) };
  if (type === "slider" && first) data.jog = 20 * niceStep(first.description.minimum, first.description.maximum);
  return data;
}
