// Short texts at points of the world.
import type { Vector3 } from "three";
import { h, setText } from "../ui/dom";
import type { Viewer } from "./viewer";

export class Labels {
  private readonly place = h("div", { class: "labels", "aria-hidden": "true" });

  constructor(container: HTMLElement, private readonly viewer: Viewer) {
    container.append(this.place);
  }

  // In each picture of the view, at the place that its eye sees.
  show(texts: readonly { at: Vector3; text: string }[]): void {
    const { left, top } = this.viewer.canvas.getBoundingClientRect();
    const shown = texts.flatMap(({ at, text }) => this.viewer.toAllPixels(at).map(({ x, y }) => ({ x: x - left, y: y - top, text })));
    while (this.place.children.length < shown.length) this.place.append(h("span", {}));
    [...this.place.children].forEach((child, i) => {
      const entry = shown[i];
      (child as HTMLElement).hidden = !entry;
      if (!entry) return;
      setText(child, entry.text);
      (child as HTMLElement).style.transform = `translate(${entry.x.toFixed(1)}px, ${entry.y.toFixed(1)}px)`;
    });
  }
}
