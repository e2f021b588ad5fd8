// The 3D view with all that belongs to it. A browser without WebGL gets a note in its place; all else of the
// page works there, too.
import type { Link } from "../link/link";
import type { Clock } from "../model/clock";
import type { Parts } from "../model/parts";
import type { Recording } from "../model/recording";
import type { World } from "../model/world";
import { h, setText } from "../ui/dom";
import { cssColor } from "../ui/palette";
import { BesideGhost } from "./beside_ghost";
import { Ghost } from "./ghost";
import { Overlays } from "./overlays";
import { Selection } from "./selection";
import { SensorOverlay } from "./sensors";
import { viewToolbar } from "./toolbar";
import { Viewer } from "./viewer";

export interface SceneView {
  viewer: Viewer;
  ghost: Ghost;
  beside: BesideGhost;
  overlays: Overlays;
  selection: Selection;
}

// Null: the browser draws no 3D.
export function makeSceneView(place: HTMLElement, link: Link, world: World, parts: Parts, clock: Clock, recording: Recording): SceneView | null {
  const viewer = viewerIn(place, world);
  place.append(emptyNote(world));
  if (!viewer) return null;
  const ghost = new Ghost(viewer, world, parts);
  const beside = new BesideGhost(viewer, world, recording);
  const overlays = new Overlays(viewer, world, new SensorOverlay(viewer, world, parts), { ghost, beside }, place);
  const selection = new Selection(viewer, world, parts, link, clock, place);
  place.append(viewToolbar(viewer, world, overlays, selection, place), ghost.sign, beside.sign);
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const paint = () => viewer.setLook(cssColor("--sky"), dark.matches);
  dark.addEventListener("change", paint);
  paint();
  return { viewer, ghost, beside, overlays, selection };
}

function viewerIn(place: HTMLElement, world: World): Viewer | null {
  try {
    // Asked first: three.js would write its own error to the console
    if (!document.createElement("canvas").getContext("webgl2")) throw new Error("it has no context for it");
    return new Viewer(place, world);
  } catch (error) {
    place.append(h("div", { class: "no-view", role: "note" }, h("h2", {}, "No 3D view here"),
      h("p", {}, `This browser does not draw 3D (WebGL): ${error instanceof Error ? error.message : String(error)}`),
      h("p", {}, "Ports, panels and plots work all the same.")));
    return null;
  }
}

// Names what of the models is not shown, and says so where there is nothing to see.
function emptyNote(world: World): HTMLElement {
  const note = h("p", { class: "not-shown", hidden: true });
  world.description.watch((description) => {
    const losses = description?.losses ?? [];
    const bodies = description?.bodies.filter(({ fixed }) => !fixed) ?? [];
    const empty = description !== null && bodies.length === 0 && description.joints.length === 0;
    note.hidden = losses.length === 0 && !empty;
    note.title = losses.join("\n");
    const missing = losses.length === 0 ? "" : `Not shown or simulated: ${losses.length === 1 ? losses[0] : `${losses.length} things of the models`}`;
    setText(note, empty ? `This scene holds nothing that moves. ${missing}` : missing);
  });
  return note;
}
