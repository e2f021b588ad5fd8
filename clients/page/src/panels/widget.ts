// The interface of a widget, and what all kinds share: their ports, their limits, writing.
import { neighbours } from "../model/neighbours";
import type { Port } from "../model/part";
import type { Parts } from "../model/parts";
import { reportError } from "../ui/toasts";
import type { WidgetData } from "./file";

export interface Widget {
  body: HTMLElement;
  update(): void; // called twenty times a second while the panel is visible
  setEnabled?(on: boolean): void; // for controls: whether this page holds the leases that they need
  dispose?(): void;
}

export interface Context {
  data: WidgetData;
  ports: Port[]; // the ports of data.ports that exist
  actual: Port | undefined;
}

export function bind(data: WidgetData, parts: Parts): Context {
  const ports = data.ports.map(({ part, port }) => parts.port(part, port)).filter((port): port is Port => port !== undefined);
  return { data, ports, actual: data.actual ? parts.port(data.actual.part, data.actual.port) : undefined };
}

export function valueOf(port: Port | undefined): number {
  return port ? port.part.value(port) : NaN;
}

// The last value that this page wrote, while it is not in force yet.
export function commandedOf(port: Port | undefined): number {
  return port ? port.part.commanded(port) : NaN;
}

export function limits({ data, ports }: Context): { minimum: number; maximum: number } {
  const own = ports[0]?.part.limits(ports[0]);
  return { minimum: data.minimum ?? own?.minimum ?? 0, maximum: data.maximum ?? own?.maximum ?? 1 };
}

// Writes the same value to all ports of a widget.
export function writeAll(ports: readonly Port[], value: number): void {
  for (const run of neighbours(ports)) run[0]!.part.writeValues(run[0]!, run.map(() => value)).catch(reportError);
}
