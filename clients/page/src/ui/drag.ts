// Drag and drop of ports from the tree to a plot or a panel.
import type { Port } from "../model/part";
import type { Parts } from "../model/parts";

const kType = "application/x-visum-ports";

export interface PortName {
  part: string;
  port: string;
}

export const nameOf = (port: Port): PortName => ({ part: port.part.name, port: port.description.name });

export function startPortDrag(event: DragEvent, ports: readonly Port[]): void {
  event.stopPropagation();
  event.dataTransfer?.setData(kType, JSON.stringify(ports.map(nameOf)));
  event.dataTransfer?.setData("text/plain", ports.map((port) => `${port.part.name}/${port.description.name}`).join("\n"));
}

// Calls `dropped` with the ports that were dropped on the element, and the place.
export function acceptPorts(element: HTMLElement, parts: Parts, dropped: (ports: Port[], event: DragEvent) => void): void {
  const carries = (event: DragEvent) => event.dataTransfer?.types.includes(kType) ?? false;
  element.addEventListener("dragover", (event) => {
    if (!carries(event)) return;
    event.preventDefault();
    element.classList.add("drop-here");
  });
  element.addEventListener("dragleave", () => element.classList.remove("drop-here"));
  element.addEventListener("drop", (event) => {
    element.classList.remove("drop-here");
    if (!carries(event)) return;
    event.preventDefault();
    const names = JSON.parse(event.dataTransfer?.getData(kType) ?? "[]") as PortName[];
    const ports = names.map(({ part, port }) => parts.port(part, port)).filter((port): port is Port => port !== undefined);
    if (ports.length > 0) dropped(ports, event);
  });
}
