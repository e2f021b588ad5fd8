// A panel file: JSON, version 1. Reading checks everything, and an error says what is wrong and where. Pure.
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

export class PanelError extends Error {}

export function emptyPanel(name = "Panel"): PanelData {
  return { visum_panel: 1, name, widgets: [] };
}

export function parsePanel(text: string): PanelData {
  let root: unknown;
  try {
    root = JSON.parse(text);
  } catch (error) {
    throw new PanelError(`the file is not JSON: ${(error as Error).message}`);
  }
  const panel = asObject(root, "the file");
  if (panel["visum_panel"] !== 1) throw new PanelError("visum_panel: must be 1, the version of the format");
  const widgets = panel["widgets"];
  if (!Array.isArray(widgets)) throw new PanelError("widgets: must be a list");
  if (widgets.length > kMostWidgets) throw new PanelError(`widgets: more than ${kMostWidgets}`);
  return {
    visum_panel: 1,
    name: text_(panel["name"], "name"),
    widgets: widgets.map((entry, i) => parseWidget(entry, `widgets[${i}]`)),
  };
}

function parseWidget(entry: unknown, at: string): WidgetData {
  const data = asObject(entry, at);
  const type = text_(data["type"], `${at}.type`) as WidgetType;
  if (!kWidgetTypes.includes(type)) throw new PanelError(`${at}.type: must be one of ${kWidgetTypes.join(", ")}, is '${type}'`);
  const ports = data["ports"] ?? [];
  if (!Array.isArray(ports)) throw new PanelError(`${at}.ports: must be a list`);
  if (ports.length > kMostPorts) throw new PanelError(`${at}.ports: more than ${kMostPorts}`);
  const widget: WidgetData = {
    type,
    label: text_(data["label"] ?? "", `${at}.label`),
    x: whole(data["x"], 0, kColumns - 1, `${at}.x`),
    y: whole(data["y"], 0, kMostRows, `${at}.y`),
    w: whole(data["w"], 1, kColumns, `${at}.w`),
    h: whole(data["h"], 1, kMostRows, `${at}.h`),
    ports: ports.map((port, i) => parsePort(port, `${at}.ports[${i}]`)),
  };
  if (widget.x + widget.w > kColumns) throw new PanelError(`${at}: reaches beyond the ${kColumns} columns`);
  return Object.assign(widget, parseSettings(data, at));
}

function parseSettings(data: Record<string, unknown>, at: string): Partial<WidgetData> {
  const settings: Partial<WidgetData> = {};
  for (const key of ["minimum", "maximum", "jog", "value", "release", "threshold", "bit", "seconds"] as const)
    if (data[key] !== undefined) settings[key] = number(data[key], `${at}.${key}`);
  if (data["actual"] !== undefined) settings.actual = parsePort(data["actual"], `${at}.actual`);
  if (data["mode"] !== undefined) {
    if (data["mode"] !== "counter" && data["mode"] !== "value") throw new PanelError(`${at}.mode: must be counter or value`);
    settings.mode = data["mode"];
  }
  if (data["spring"] !== undefined) settings.spring = data["spring"] === true;
  if (data["bits"] !== undefined) settings.bits = list(data["bits"], `${at}.bits`).map((bit, i) => text_(bit, `${at}.bits[${i}]`));
  if (data["scales"] !== undefined) settings.scales = list(data["scales"], `${at}.scales`).map((scale, i) => whole(scale, 0, 1, `${at}.scales[${i}]`));
  if (data["choices"] !== undefined) settings.choices = list(data["choices"], `${at}.choices`).map((choice, i) => parseChoice(choice, `${at}.choices[${i}]`));
  return settings;
}

function parseChoice(entry: unknown, at: string): Choice {
  const choice = asObject(entry, at);
  return { label: text_(choice["label"], `${at}.label`), value: number(choice["value"], `${at}.value`) };
}

function parsePort(entry: unknown, at: string): PortName {
  const port = asObject(entry, at);
  return { part: text_(port["part"], `${at}.part`), port: text_(port["port"], `${at}.port`) };
}

function asObject(value: unknown, at: string): Record<string, unknown> {
  if (typeof value !== "object" || value === null || Array.isArray(value)) throw new PanelError(`${at}: must be a map`);
  return value as Record<string, unknown>;
}
function list(value: unknown, at: string): unknown[] {
  if (!Array.isArray(value)) throw new PanelError(`${at}: must be a list`);
  return value;
}
function text_(value: unknown, at: string): string {
  if (typeof value !== "string") throw new PanelError(`${at}: must be a text`);
  return value;
}
function number(value: unknown, at: string): number {
  if (typeof value !== "number" || !Number.isFinite(value)) throw new PanelError(`${at}: must be a number`);
  return value;
}
function whole(value: unknown, least: number, most: number, at: string): number {
  const found = number(value, at);
  if (!Number.isInteger(found) || found < least || found > most) throw new PanelError(`${at}: must be a whole number from ${least} to ${most}`);
  return found;
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
