// A panel file: JSON, version 1. Reading checks everything, and an error says what is wrong and where. Pure.
import { asList, asNumber, asObject, asText, asWhole, BadFileError, parseObject } from "../common/checked";
import type { PortName } from "../ui/drag";

export const kWidgetTypes = ["slider", "number", "button", "radio", "stick", "bits", "led", "lcd", "bar", "gauge", "scope", "label"] as const;
export type WidgetType = (typeof kWidgetTypes)[number];
export const kColumns = 12;
export const kMostRows = 200;
export const kMostWidgets = 200;
export const kMostPorts = 48; // of a widget

export interface Choice {
  label: string;
  value: number;
}

export interface WidgetData {
  type: WidgetType;
  label: string;
  x: number; // cells of a grid of 12 columns
  y: number;
  w: number;
  h: number;
  // slider, number, button: inputs that get the same value; stick: its two axes; scope: its traces
  ports: PortName[];
  actual?: PortName; // slider: shown beside the commanded value
  minimum?: number; // replaces the port's own
  maximum?: number;
  jog?: number; // slider: the step of its two buttons
  mode?: "counter" | "value"; // button
  value?: number; // button: the value while it is pressed
  release?: number; // button, mode value: the value when it is let go; none: nothing is written
  choices?: Choice[]; // radio
  threshold?: number; // led
  bit?: number; // led: this bit instead of a threshold
  bits?: string[]; // bits: names, from bit 0
  seconds?: number; // scope
  scales?: number[]; // scope: 0 (left) or 1 (right) for each trace
  spring?: boolean; // stick: returns to its middle
}

export interface PanelData {
  visum_panel: 1;
  name: string;
  widgets: WidgetData[];
}

export function emptyPanel(name = "Panel"): PanelData {
  return { visum_panel: 1, name, widgets: [] };
}

export const parsePanel = (text: string): PanelData => readPanel(parseObject(text));

export function readPanel(panel: Record<string, unknown>): PanelData {
  if (panel["visum_panel"] !== 1) throw new BadFileError("visum_panel: must be 1, the version of the format");
  return {
    visum_panel: 1,
    name: asText(panel["name"], "name"),
    widgets: asList(panel["widgets"], "widgets", kMostWidgets).map((entry, i) => parseWidget(entry, `widgets[${i}]`)),
  };
}

function parseWidget(entry: unknown, at: string): WidgetData {
  const data = asObject(entry, at);
  const type = asText(data["type"], `${at}.type`) as WidgetType;
  if (!kWidgetTypes.includes(type)) throw new BadFileError(`${at}.type: must be one of ${kWidgetTypes.join(", ")}, is '${type}'`);
  const ports = asList(data["ports"] ?? [], `${at}.ports`, kMostPorts);
  const widget: WidgetData = {
    type,
    label: asText(data["label"] ?? "", `${at}.label`),
    x: asWhole(data["x"], 0, kColumns - 1, `${at}.x`),
    y: asWhole(data["y"], 0, kMostRows, `${at}.y`),
    w: asWhole(data["w"], 1, kColumns, `${at}.w`),
    h: asWhole(data["h"], 1, kMostRows, `${at}.h`),
    ports: ports.map((port, i) => parsePort(port, `${at}.ports[${i}]`)),
  };
  if (widget.x + widget.w > kColumns) throw new BadFileError(`${at}: reaches beyond the ${kColumns} columns`);
  return Object.assign(widget, parseSettings(data, at));
}

function parseSettings(data: Record<string, unknown>, at: string): Partial<WidgetData> {
  const settings: Partial<WidgetData> = {};
  for (const key of ["minimum", "maximum", "jog", "value", "release", "threshold", "bit", "seconds"] as const)
    if (data[key] !== undefined) settings[key] = asNumber(data[key], `${at}.${key}`);
  if (data["actual"] !== undefined) settings.actual = parsePort(data["actual"], `${at}.actual`);
  if (data["mode"] !== undefined) {
    if (data["mode"] !== "counter" && data["mode"] !== "value") throw new BadFileError(`${at}.mode: must be counter or value`);
    settings.mode = data["mode"];
  }
  if (data["spring"] !== undefined) settings.spring = data["spring"] === true;
  if (data["bits"] !== undefined) settings.bits = asList(data["bits"], `${at}.bits`).map((bit, i) => asText(bit, `${at}.bits[${i}]`));
  if (data["scales"] !== undefined) settings.scales = asList(data["scales"], `${at}.scales`).map((scale, i) => asWhole(scale, 0, 1, `${at}.scales[${i}]`));
  if (data["choices"] !== undefined) settings.choices = asList(data["choices"], `${at}.choices`).map((choice, i) => parseChoice(choice, `${at}.choices[${i}]`));
  return settings;
}

function parseChoice(entry: unknown, at: string): Choice {
  const choice = asObject(entry, at);
  return { label: asText(choice["label"], `${at}.label`), value: asNumber(choice["value"], `${at}.value`) };
}

export function parsePort(entry: unknown, at: string): PortName {
  const port = asObject(entry, at);
  return { part: asText(port["part"], `${at}.part`), port: asText(port["port"], `${at}.port`) };
}

export function formatPanel(panel: PanelData): string {
  return `${JSON.stringify(panel, null, 1)}\n`;
}

// The first free place for a widget of this width and height, row by row. Pure.
export function freePlace(widgets: readonly WidgetData[], w: number, h: number): { x: number; y: number } {
  const taken = (x: number, y: number) =>
    widgets.some((other) => x < other.x + other.w && other.x < x + w && y < other.y + other.h && other.y < y + h);
  for (let y = 0; ; ++y) for (let x = 0; x + w <= kColumns; ++x) if (!taken(x, y)) return { x, y };
}
