// The selected body: its name, its motion, the ports that drive it. With the role for it, the user pulls a
// body by a spring, as if by hand: Ctrl or Alt with the pointer, or a long press of a finger.
import { Vector3 } from "three";
import type { Link } from "../link/link";
import type { Clock } from "../model/clock";
import type { Parts } from "../model/parts";
import { Emitter } from "../common/signal";
import type { World } from "../model/world";
import { h, iconButton, setText } from "../ui/dom";
import { icons } from "../ui/icons";
import { formatInRange, formatValue } from "../ui/numbers";
import { reportError } from "../ui/toasts";
import { drivingPorts } from "./driving_ports";
import { Pull } from "./pull";
import type { Viewer } from "./viewer";

const kClickPixels = 4;
const kLongPressMs = 450; // of a finger, which has no Ctrl
const kStillPixels = 8;

export class Selection {
  readonly selected = new Emitter<number>(); // body; -1: none
  private body = -1;
  private readonly pull: Pull;
  private readonly title = h("h2", {});
  private readonly facts = h("dl", {});
  private readonly card: HTMLElement;
  // In a narrow view
  private readonly more = h("button", { type: "button", class: "small more", "aria-expanded": "false" }, "More");
  private readonly follow = h("button", { type: "button", class: "small", "aria-pressed": "false" }, "Follow");

  constructor(private readonly viewer: Viewer, private readonly world: World, private readonly parts: Parts, private readonly link: Link, clock: Clock, container: HTMLElement) {
    this.pull = new Pull(viewer, link, () => clock.status.value?.realTimeFactor ?? 1, reportError);
    this.card = h("section", { class: "body-card", hidden: true, "aria-label": "Selected body" },
      h("header", {}, this.title, this.more, this.follow, iconButton(icons.close, "Close", () => this.select(-1))), this.facts);
    container.append(this.card);
    this.follow.addEventListener("click", () => this.toggleFollow());
    this.more.addEventListener("click", () => this.more.setAttribute("aria-expanded", String(this.more.getAttribute("aria-expanded") !== "true")));
    this.listen(viewer.canvas);
    world.description.watch(() => this.letGo());
    viewer.rebuilt.on(() => this.letGo());
    setInterval(() => this.refresh(), 100);
  }

  select(body: number): void {
    this.body = body;
    this.viewer.bodies.select(body);
    this.selected.emit(body);
    this.card.hidden = body < 0;
    this.card.classList.toggle("low", this.isInUpperHalf());
    setText(this.title, this.name);
    this.follow.setAttribute("aria-pressed", String(this.isFollowed()));
    this.refresh();
    this.viewer.redraw();
  }

  // After this the numbers of bodies mean other bodies.
  private letGo(): void {
    this.endPull();
    this.select(-1);
  }

  private listen(canvas: HTMLCanvasElement): void {
    let down = { x: 0, y: 0 };
    let press = 0; // the timer of a long press
    const moved = (event: PointerEvent) => Math.hypot(event.clientX - down.x, event.clientY - down.y);
    // In the capturing phase, so that a pull does not orbit the camera.
    canvas.addEventListener("pointerdown", (event) => {
      down = { x: event.clientX, y: event.clientY };
      clearTimeout(press);
      // A second finger zooms
      if (event.pointerType === "touch" && event.isPrimary) press = window.setTimeout(() => this.beginPull(event), kLongPressMs);
      if ((event.ctrlKey || event.altKey) && this.beginPull(event)) event.stopImmediatePropagation();
    }, { capture: true });
    canvas.addEventListener("pointermove", (event) => {
      if (moved(event) > kStillPixels) clearTimeout(press);
      if (this.pull.isPulling) this.pull.moveTo(this.viewer.rayAt(event.clientX, event.clientY));
    });
    // A long press would open it
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("pointercancel", () => (clearTimeout(press), this.endPull()));
    canvas.addEventListener("pointerup", (event) => {
      clearTimeout(press);
      if (this.pull.isPulling) return this.endPull();
      if (moved(event) < kClickPixels) this.select(this.hit(event)?.body ?? -1);
    });
  }

  // In a narrow view the card lies in the other half, so as not to hide its body.
  private isInUpperHalf(): boolean {
    const group = this.viewer.bodies.groups[this.body];
    const at = group && this.viewer.toPixels(group.getWorldPosition(new Vector3()));
    const { top, height } = this.viewer.canvas.getBoundingClientRect();
    return !!at && at.y < top + height / 2;
  }

  private toggleFollow(): void {
    this.viewer.followed = this.isFollowed() ? "" : this.name;
    this.viewer.redraw(); // the camera takes hold of the body where it is drawn
    this.follow.setAttribute("aria-pressed", String(this.isFollowed()));
  }

  private get name(): string {
    return this.world.description.value?.bodies[this.body]?.name ?? "";
  }
  private isFollowed(): boolean {
    return this.name !== "" && this.viewer.followed === this.name;
  }

  private hit(event: PointerEvent): { body: number; point: Vector3 } | null {
    if (!this.viewer.isUpToDate) return null;
    const found = this.viewer.rayAt(event.clientX, event.clientY).intersectObjects(this.viewer.bodies.groups, true).find(({ object }) => object.visible);
    return found ? { body: Number(found.object.parent?.userData["body"] ?? -1), point: found.point } : null;
  }

  private beginPull(event: PointerEvent): boolean {
    if (!this.viewer.view.controls.enabled) return false; // the tool's handles are dragged
    const hit = this.hit(event);
    const body = hit && this.world.description.value?.bodies[hit.body];
    if (!hit || !body || body.fixed || !this.link.mayChangeWorld) return false;
    this.select(hit.body);
    this.pull.begin(hit.body, body, hit.point);
    this.card.classList.add("pulling");
    this.viewer.canvas.setPointerCapture(event.pointerId);
    this.viewer.view.controls.enabled = false;
    return true;
  }

  private endPull(): void {
    this.pull.end();
    this.card.classList.remove("pulling");
    this.viewer.view.controls.enabled = true;
  }

  private refresh(): void {
    const description = this.world.description.value?.bodies[this.body];
    const sample = this.world.sample;
    if (!description || !sample) return;
    const at = 7 * this.body;
    const numbers = (values: number[]) => values.map((value) => formatInRange(value, 0, 5, "m")).join(", ");
    const speed = sample.velocities.slice(6 * this.body, 6 * this.body + 3);
    const rows: [string, string][] = [
      ["Position", `${numbers(sample.poses.slice(at, at + 3))} m`],
      ["Speed", `${formatInRange(Math.hypot(...speed), 0, 5, "m/s")} m/s`],
      ["Contact force", `${formatInRange(sample.peakContactForces[this.body] ?? 0, 0, 200, "N")} N`],
      ["Orientation", `${numbers(sample.poses.slice(at + 3, at + 7))} (w x y z)`],
      ["Mass", description.fixed ? "stands still" : `${formatValue(description.massKg, "kg")} kg`],
      ["Driven by", drivingPorts(this.world, this.parts, description.name).join("; ") || "nothing"],
    ];
    if (!description.fixed && this.link.mayChangeWorld) rows.push(["Pull", matchMedia("(pointer: coarse)").matches ? "press long, then drag" : "Ctrl and drag"]);
    while (this.facts.children.length > 2 * rows.length) this.facts.lastElementChild!.remove();
    while (this.facts.children.length < 2 * rows.length) this.facts.append(h("dt", {}), h("dd", {}));
    rows.forEach(([name, value], i) => (setText(this.facts.children[2 * i]!, name), setText(this.facts.children[2 * i + 1]!, value)));
  }
}
