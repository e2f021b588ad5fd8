// The pictures of the world's cameras, as tiles over the view. A click enlarges one. Pictures are large: each
// tile asks for the next one a while after the last.
import type { Part } from "../model/part";
import type { Parts } from "../model/parts";
import { poll } from "../model/poll";
import { h, iconButton } from "../ui/dom";
import { icons } from "../ui/icons";
import { reportError } from "../ui/toasts";
import { show } from "./blackboards";
import { kCameraType } from "./camera_image";

const kPeriodMs = 1000;
const kEnlargedMs = 250;
const kMost = 8;

export class CameraTiles {
  readonly element = h("section", { class: "tiles", "aria-label": "Cameras", hidden: true });
  private stops: (() => void)[] = [];
  private closed = false;

  constructor(parts: Parts) {
    parts.list.watch((list) => this.build(list));
    document.addEventListener("keydown", ({ key }) => key === "Escape" && this.enlarge(null));
  }

  private build(list: readonly Part[]): void {
    for (const stop of this.stops) stop();
    const cameras = list.flatMap((part) => part.description.blackboards
      .filter(({ contentType }) => contentType.startsWith(kCameraType)).map((board) => ({ part, board: board.name })));
    this.element.hidden = cameras.length === 0 || this.closed;
    const tiles = cameras.slice(0, kMost).map(({ part, board }) => this.tile(part, board));
    this.stops = tiles.map(({ stop }) => stop);
    const close = iconButton(icons.close, "Close the cameras", () => ((this.closed = true), (this.element.hidden = true)), { class: "icon tiles-close" });
    this.element.replaceChildren(...tiles.map(({ element }) => element), close);
  }

  private enlarge(tile: HTMLElement | null): void {
    for (const one of this.element.querySelectorAll(".tile")) one.setAttribute("aria-pressed", String(one === tile));
  }

  private tile(part: Part, board: string): { element: HTMLElement; stop: () => void } {
    const picture = h("span", { class: "tile-picture" });
    const element = h("button", { type: "button", class: "tile", "aria-pressed": "false", "aria-label": `Camera ${part.name}` }, picture, h("span", { class: "tile-name" }, part.name));
    const description = part.description.blackboards.find(({ name }) => name === board)!;
    let generation = -1n;
    let next = 0;
    const enlarged = () => element.getAttribute("aria-pressed") === "true";
    element.addEventListener("click", () => this.enlarge(enlarged() ? null : element));
    const refresh = async () => {
      if (document.hidden || this.element.hidden || performance.now() < next) return;
      const data = await part.readBlackboard(board);
      next = performance.now() + (enlarged() ? 0 : kPeriodMs - kEnlargedMs / 2);
      if (data.generation === generation) return;
      generation = data.generation;
      picture.replaceChildren(show(description, data.data));
    };
    return { element, stop: poll(() => refresh().catch(reportError), kEnlargedMs) };
  }
}
