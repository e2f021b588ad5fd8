// Bodies that come and go: simple shapes at a place, and any free body of the world away.
import type { Link } from "../link/link";
import type { World } from "../model/world";
import { h } from "../ui/dom";
import { actButton, section } from "./act";

// As in a scene's file.
const kShapes: Record<string, string> = {
  box: "shapes: [{box: [0.06, 0.06, 0.06], color: [0.13, 0.42, 0.73, 1.0]}]",
  ball: "shapes: [{sphere: 0.04, color: [0.8, 0.4, 0.1, 1.0]}]",
  cylinder: "shapes: [{cylinder: {radius: 0.03, length: 0.1}, color: [0.2, 0.6, 0.3, 1.0]}]",
};
const kMassKg = 0.2;

export class BodiesSection {
  readonly element: HTMLElement;
  private readonly shape = h("select", { "aria-label": "Shape of the body" }, ...Object.keys(kShapes).map((name) => h("option", { value: name }, name)));
  private readonly place = h("input", { type: "text", value: "0.5, 0, 0.6", "aria-label": "Place of the body: x, y, z in m" });
  private readonly gone = h("select", { "aria-label": "Body to remove" });

  constructor(private readonly link: Link, private readonly world: World) {
    this.element = section("Bodies", h("div", { class: "menu-row" }, this.shape, this.place, actButton("Add", () => this.add())),
      h("div", { class: "menu-row" }, this.gone, actButton("Remove", () => this.remove())));
    world.description.watch((description) => {
      const free = (description?.bodies ?? []).filter(({ fixed, model }) => !fixed && model === "");
      this.gone.replaceChildren(...free.map(({ name }) => h("option", { value: name }, name)));
    });
  }

  private async add(): Promise<string> {
    const xyz = this.place.value.split(/[\s,]+/).filter(Boolean).map(Number);
    if (xyz.length !== 3 || !xyz.every(Number.isFinite)) throw new Error("The place must be three numbers: x, y, z");
    const name = freeBody(this.world.description.value?.bodies.map((body) => body.name) ?? [], this.shape.value);
    await this.link.request({ case: "addBody", value: { yaml: `{name: ${name}, mass: ${kMassKg}, pose: {xyz: [${xyz.join(", ")}]}, ${kShapes[this.shape.value]}}` } }, "ok");
    return `'${name}' is here`;
  }

  private async remove(): Promise<string> {
    const body = this.gone.value;
    if (body === "") throw new Error("There is no free body to remove");
    await this.link.request({ case: "removeBody", value: { body } }, "ok");
    return `'${body}' is gone`;
  }
}

// A name that no body has: box, box_2, ... Pure.
export function freeBody(taken: readonly string[], wanted: string): string {
  if (!taken.includes(wanted)) return wanted;
  for (let i = 2; ; ++i) if (!taken.includes(`${wanted}_${i}`)) return `${wanted}_${i}`;
}
