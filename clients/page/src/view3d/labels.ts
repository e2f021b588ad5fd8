// Short texts at points of the world.
import type { Vector3 } from "three";
import { h, setText } from "../ui/dom";
import type { Viewer } from "./viewer";

export class Labels {
  private readonly place = h("div", { class: "labels", "aria-hidden": "true" });

  constructor(container: HTMLElement, private readonly viewer: Viewer) {
    container.append(this.place);
  }

  show(texts: readonly { at: Vector3; text: string }[]): void {
    while (this.place.children.length < texts.length) this.place.append(h("span", {}));
    const { left, top } = this.viewer.canvas.getBoundingClientRect();
    [...this.place.children].forEach((child, i) => {
      const entry = texts[i];
      const pixels = entry && this.viewer.toPixels(entry.at);
      (child as HTMLElement).hidden = !pixels;
      if (!pixels) return;
      setText(child, entry.text);
      (child as HTMLElement).style.transform = `translate(${(pixels.x - left).toFixed(1)}px, ${(pixels.y - top).toFixed(1)}px)`;
    });
  }
}
