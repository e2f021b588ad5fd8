// The list of taught poses: save, order, go to, play, loop, export. The browser keeps it for each scene.
import type { Signal } from "../common/signal";
import type { Part } from "../model/part";
import { kDesired } from "../model/desired";
import type { World } from "../model/world";
import { h, iconButton, setText } from "../ui/dom";
import { download } from "../ui/files";
import { icons } from "../ui/icons";
import { report, reportError } from "../ui/toasts";
import type { Arm } from "./arm";
import type { Mover } from "./mover";
import { Player } from "./player";
import { asPython, asScenario, freeName, moved, readCourse, type Course } from "./teach";

const kStored = "visum.poses.";
const kSecondsEach = 8; // in an exported scenario

export class TeachView {
  readonly element = h("section", { class: "teach", "aria-label": "Taught poses" });
  private readonly list = h("ol", { class: "poses" });
  private readonly loop = h("input", { type: "checkbox" });
  private readonly save = h("button", { type: "button", onclick: () => this.add() }, "Save pose");
  private readonly play = h("button", { type: "button", class: "primary", onclick: () => this.toggle() }, "Play");
  private readonly player = new Player();
  private course: Course = { part: "", poses: [] };
  private usable = false;

  constructor(private readonly world: World, private readonly arm: Signal<Arm | null>, private readonly mover: Mover) {
    this.element.append(h("div", { class: "teach-tools" }, this.save, this.play, h("label", { class: "check" }, this.loop, h("span", {}, "Loop"))),
      h("div", { class: "teach-tools" }, h("span", {}, "Export as"), h("button", { type: "button", class: "small", title: "Export as a controller in Python", onclick: () => this.exportPython() }, "Python"),
      h("button", { type: "button", class: "small", title: "Export as a scenario", onclick: () => this.exportScenario() }, "Scenario")),
    this.list);
    arm.watch((now) => this.use(now?.part.name ?? ""));
    this.player.playing.watch(() => this.show());
  }

  enable(on: boolean): void {
    if (on === this.usable) return;
    this.usable = on;
    if (!on) this.player.stop();
    this.show();
  }

  private get part(): Part | null {
    return this.arm.value?.part ?? null;
  }
  private get key(): string {
    return `${kStored}${this.world.description.value?.scene ?? ""}.${this.course.part}`;
  }

  private use(part: string): void {
    this.player.stop();
    this.course = { part, poses: [] };
    const kept = localStorage.getItem(this.key);
    try {
      if (kept) this.course = readCourse(kept);
    } catch (error) {
      reportError(error);
    }
    this.show();
  }

  private keep(course: Course): void {
    this.course = course;
    localStorage.setItem(this.key, JSON.stringify(course));
    this.show();
  }

  private add(): void {
    if (!this.part) return;
    const ports = this.part.ports.filter(({ side, description }) => side === "input" && kDesired.test(description.group));
    const values = Object.fromEntries(ports.map((port) => [port.description.name, Number(port.part.commanded(port).toPrecision(9))]));
    this.keep({ ...this.course, poses: [...this.course.poses, { name: freeName(this.course.poses), values }] });
  }

  private toggle(): void {
    if (this.player.playing.value >= 0) return this.player.stop();
    this.run(0, this.course.poses.length - 1, () => this.loop.checked);
  }

  private run(first: number, last: number, loop: () => boolean): void {
    if (!this.part || last < first) return;
    this.mover.halt();
    this.player.play(this.part, this.course.poses, first, last, loop).catch((error: Error) => report(error.message, "error"));
  }

  private show(): void {
    const { poses } = this.course;
    const playing = this.player.playing.value;
    setText(this.play, playing >= 0 ? "Stop playing" : "Play");
    this.play.disabled = !this.usable || poses.length === 0;
    this.save.disabled = this.part === null;
    this.list.replaceChildren(...poses.map((pose, i) => this.row(pose.name, i, playing === i)));
  }

  private row(name: string, index: number, playing: boolean): HTMLElement {
    const { poses } = this.course;
    const input = h("input", { type: "text", value: name, "aria-label": `Name of pose ${index + 1}` });
    input.addEventListener("change", () => this.keep({ ...this.course, poses: poses.map((pose, i) => (i === index ? { ...pose, name: input.value || pose.name } : pose)) }));
    const move = (by: number) => () => this.keep({ ...this.course, poses: moved(poses, index, by) });
    return h("li", { class: playing ? "pose playing" : "pose", "aria-current": playing ? "step" : undefined }, input,
      h("button", { type: "button", class: "small", disabled: !this.usable, "aria-label": `Go to ${name}`, onclick: () => this.run(index, index, () => false) }, "Go"),
      h("button", { type: "button", class: "small", disabled: index === 0, "aria-label": `${name} earlier`, onclick: move(-1) }, "↑"),
      h("button", { type: "button", class: "small", disabled: index + 1 === poses.length, "aria-label": `${name} later`, onclick: move(1) }, "↓"),
      iconButton(icons.close, `Forget ${name}`, () => this.keep({ ...this.course, poses: poses.filter((_, i) => i !== index) })));
  }

  private exportPython(): void {
    if (this.hasPoses()) download("taught.py", new Blob([asPython(this.course, this.loop.checked)], { type: "text/x-python" }));
  }

  private exportScenario(): void {
    const scene = this.world.description.value?.scene ?? "scene";
    if (this.hasPoses()) download("taught.yaml", new Blob([asScenario(this.course, `${scene}.yaml`, `${scene}_taught`, kSecondsEach)], { type: "text/yaml" }));
  }

  private hasPoses(): boolean {
    if (this.course.poses.length === 0) report("There is no pose to export; save one first", "error");
    return this.course.poses.length > 0;
  }
}
