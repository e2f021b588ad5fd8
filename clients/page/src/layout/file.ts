// A layout as it is kept and shared: the panes that are open, the plots, and in a link also the panel and the
// camera. Pure.
import { asList, asNumber, asObject, BadFileError, parseObject } from "../common/checked";
import { kMostPorts, parsePort, readPanel, type PanelData } from "../panels/file";
import type { PlotData } from "../plots/plot";
import type { OpenPanes } from "../ui/layout";

export interface CameraData {
  position: [number, number, number];
  target: [number, number, number];
  fov: number; // degrees, vertical
}

export interface LayoutData {
  visum_layout: 1;
  panes: OpenPanes;
  plots: PlotData[];
  panel?: PanelData;
  camera?: CameraData;
}

const kMostPlots = 16;

// Throws a BadFileError that says what is wrong.
export function parseLayout(text: string): LayoutData {
  const root = parseObject(text);
  if (root["visum_layout"] !== 1) throw new BadFileError("visum_layout: must be 1, the version of the format");
  const panes = asObject(root["panes"], "panes");
  const open = (name: keyof OpenPanes) => panes[name] === true;
  const data: LayoutData = {
    visum_layout: 1, panes: { parts: open("parts"), panel: open("panel"), plots: open("plots"), log: open("log") },
    plots: asList(root["plots"], "plots", kMostPlots).map((plot, i) => plotOf(plot, `plots[${i}]`)),
  };
  if (root["panel"] !== undefined) data.panel = readPanel(asObject(root["panel"], "panel"));
  if (root["camera"] !== undefined) data.camera = cameraOf(asObject(root["camera"], "camera"));
  return data;
}

function plotOf(value: unknown, at: string): PlotData {
  const plot = asObject(value, at);
  const ports = asList(plot["ports"], `${at}.ports`, kMostPorts).map((port, i) => parsePort(port, `${at}.ports[${i}]`));
  return { ports, seconds: asNumber(plot["seconds"], `${at}.seconds`) };
}

function cameraOf({ position, target, fov }: Record<string, unknown>): CameraData {
  const triple = (value: unknown, at: string): [number, number, number] => {
    const [x, y, z] = asList(value, at, 3);
    return [asNumber(x, at), asNumber(y, at), asNumber(z, at)];
  };
  return { position: triple(position, "camera.position"), target: triple(target, "camera.target"), fov: asNumber(fov, "camera.fov") };
}
