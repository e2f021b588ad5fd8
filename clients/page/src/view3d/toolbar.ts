// The toolbar over the view: viewpoints, overlays, stereo, a picture, full screen.
import type { World } from "../model/world";
import { h, iconButton } from "../ui/dom";
import { download } from "../ui/files";
import { icons } from "../ui/icons";
import { popover } from "../ui/popover";
import { report } from "../ui/toasts";
import { kOverlays, type OverlayName, type Overlays } from "./overlays";
import type { Selection } from "./selection";
import type { StereoMode } from "./stereo";
import type { Viewer } from "./viewer";

const kStereo: [StereoMode, string][] = [["off", "Off"], ["side-by-side", "Side by side"], ["top-bottom", "Top and bottom"], ["anaglyph", "Anaglyph (red, cyan)"]];

export function viewToolbar(viewer: Viewer, world: World, overlays: Overlays, selection: Selection, container: HTMLElement): HTMLElement {
  const full = () => (document.fullscreenElement ? document.exitFullscreen() : container.requestFullscreen()).catch((error: Error) => report(error.message, "error"));
  const picture = async () => {
    const blob = await viewer.toBlob();
    if (blob) download(`${world.description.value?.scene ?? "world"}.png`, blob);
  };
  return h("div", { class: "view-tools", role: "toolbar", "aria-label": "View" },
    bodyMenu(world, selection),
    viewpointMenu(viewer, world),
    popover("Overlays", overlayMenu(overlays), icons.layers),
    popover("Stereo", stereoMenu(viewer), icons.glasses),
    iconButton(icons.image, "Save a picture of the view", () => void picture()),
    iconButton(icons.expand, "Full screen", () => void full()));
}

// Does what a click on a body does, for users who do not click.
function bodyMenu(world: World, selection: Selection): HTMLElement {
  const choice = h("select", { "aria-label": "Selected body", title: "Selected body" });
  world.description.watch((description) => {
    const names = description?.bodies.map(({ name }) => name) ?? [];
    choice.replaceChildren(h("option", { value: "-1" }, "No body"), ...names.map((name, i) => h("option", { value: String(i) }, name)));
  });
  choice.addEventListener("change", () => selection.select(Number(choice.value)));
  selection.selected.on((body) => (choice.value = String(body)));
  return choice;
}

function viewpointMenu(viewer: Viewer, world: World): HTMLElement {
  const choice = h("select", { "aria-label": "Viewpoint", title: "Viewpoint" });
  world.description.watch((description) => {
    const names = ["Home", ...(description?.viewpoints.map(({ name }) => name) ?? [])];
    choice.replaceChildren(h("option", { value: "", disabled: true, selected: true, hidden: true }, "Viewpoint"), ...names.map((name) => h("option", { value: name }, name)));
  });
  choice.addEventListener("change", () => {
    const found = world.description.value?.viewpoints.find(({ name }) => name === choice.value);
    if (!found) viewer.view.goHome();
    else viewer.view.look({ name: found.name, position: triple(found.position), target: triple(found.target), fov: (found.fov * 180) / Math.PI });
    choice.value = "";
  });
  return choice;
}

function triple([x = 0, y = 0, z = 0]: number[]): [number, number, number] {
  return [x, y, z];
}

function overlayMenu(overlays: Overlays): HTMLElement {
  const rows = (Object.keys(kOverlays) as OverlayName[]).map((name) => {
    const box = h("input", { type: "checkbox", checked: overlays.on[name] });
    box.addEventListener("change", () => overlays.set(name, box.checked));
    return h("label", { class: "check" }, box, h("span", {}, kOverlays[name]));
  });
  return h("div", {}, ...rows);
}

function stereoMenu(viewer: Viewer): HTMLElement {
  const mode = h("select", { "aria-label": "Stereo mode" }, ...kStereo.map(([value, name]) => h("option", { value }, name)));
  mode.addEventListener("change", () => ((viewer.stereo.mode = mode.value as StereoMode), viewer.redraw()));
  const distance = (key: "eyes" | "screen", minimum: number, maximum: number) => {
    const input = h("input", { type: "number", min: minimum, max: maximum, step: "any", value: viewer.stereo[key] });
    input.addEventListener("change", () => {
      if (!(input.valueAsNumber >= minimum && input.valueAsNumber <= maximum)) return report(`must be from ${minimum} to ${maximum} m`, "error");
      viewer.stereo[key] = input.valueAsNumber;
      viewer.redraw();
    });
    return input;
  };
  const swap = h("input", { type: "checkbox" });
  swap.addEventListener("change", () => ((viewer.stereo.swapped = swap.checked), viewer.redraw()));
  const field = (name: string, input: HTMLElement) => h("label", { class: "field" }, h("span", {}, name), input);
  return h("div", { class: "stereo" }, field("Mode", mode), field("Eyes apart, m", distance("eyes", 0, 1)), field("Screen at, m", distance("screen", 0.05, 100)),
    h("label", { class: "check" }, swap, h("span", {}, "Swap the eyes")));
}
