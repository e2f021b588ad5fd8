// A part's blackboards, shown by their content: text, a picture, numbers, or bytes. They are read while their
// list is open.
import type { Link } from "../link/link";
import type { BlackboardDescription } from "../link/messages";
import type { Part } from "../model/part";
import { poll } from "../model/poll";
import { h } from "../ui/dom";
import { reportError } from "../ui/toasts";
import { decodeCamera, kCameraType } from "./camera_image";

const kRefreshMs = 1000;
const kMostNumbers = 256;
const kMostBytes = 512;

export function blackboardsView(link: Link, part: Part): { element: HTMLElement; stop: () => void } | null {
  const boards = part.description.blackboards;
  if (boards.length === 0) return null;
  const views = boards.map((board) => ({ board, body: h("div", { class: "blackboard" }), generation: -1n }));
  const element = h(
    "details",
    { class: "side" },
    h("summary", {}, h("span", {}, "Blackboards"), h("span", { class: "count" }, String(boards.length))),
    ...views.map(({ board, body }) => h("div", {}, h("h3", {}, `${board.name} · ${board.contentType}`), body)),
  );
  const refresh = async () => {
    if (!element.open || document.hidden || !link.welcome) return;
    for (const view of views) {
      const data = await part.readBlackboard(view.board.name);
      if (data.generation === view.generation) continue;
      view.generation = data.generation;
      view.body.replaceChildren(show(view.board, data.data));
    }
  };
  return { element, stop: poll(() => refresh().catch(reportError), kRefreshMs) };
}

export function show(board: BlackboardDescription, bytes: Uint8Array): HTMLElement {
  const type = board.contentType;
  if (type.startsWith("text/") || type === "application/json") return h("pre", {}, new TextDecoder().decode(bytes));
  if (type.startsWith(kCameraType)) return cameraPicture(bytes, board.name);
  if (type.startsWith("image/")) return picture(type, bytes, board.name);
  const numbers = asNumbers(board, bytes);
  if (!numbers) return h("pre", {}, hex(bytes.subarray(0, kMostBytes)));
  const list = h("ol", { class: "numbers", start: 0 });
  for (const value of numbers.slice(0, kMostNumbers)) list.append(h("li", {}, String(Number(value.toPrecision(7)))));
  return list;
}

function picture(type: string, bytes: Uint8Array, name: string): HTMLElement {
  const url = URL.createObjectURL(new Blob([new Uint8Array(bytes)], { type }));
  return h("img", { src: url, alt: name, onload: () => URL.revokeObjectURL(url) });
}

function cameraPicture(bytes: Uint8Array, name: string): HTMLElement {
  const image = decodeCamera(bytes);
  if (!image) return h("p", { class: "empty" }, "No picture yet.");
  const { width, height } = image;
  const canvas = h("canvas", { width, height, role: "img", "aria-label": `${name}, taken at ${image.takenS.toFixed(3)} s` });
  canvas.getContext("2d")!.putImageData(new ImageData(image.rgba, width, height), 0, 0);
  return canvas;
}

// Scans and vectors: floats, by the size of an element.
function asNumbers(board: BlackboardDescription, bytes: Uint8Array): number[] | null {
  const copy = bytes.slice().buffer;
  if (board.elementSize === 8n) return [...new Float64Array(copy, 0, Math.floor(copy.byteLength / 8))];
  if (board.elementSize === 4n) return [...new Float32Array(copy, 0, Math.floor(copy.byteLength / 4))];
  return null;
}

function hex(bytes: Uint8Array): string {
  return [...bytes].map((byte, i) => byte.toString(16).padStart(2, "0") + (i % 16 === 15 ? "\n" : " ")).join("");
}
