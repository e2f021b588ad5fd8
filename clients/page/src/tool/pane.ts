// The tab "Tool": where the tool is, coordinates to type, a jog by axes, and the poses that were taught.
import { hindrance } from "../bar/part_state";
import { compose, toRpy, fromRpy, type Pose, type Vector } from "../kinematics/pose";
import { Signal } from "../common/signal";
import type { Link } from "../link/link";
import type { Parts } from "../model/parts";
import type { World } from "../model/world";
import { h, setText } from "../ui/dom";
import { formatValue } from "../ui/numbers";
import { report, reportError } from "../ui/toasts";
import { armOf, bodyPose, tools, type Arm } from "./arm";
import { fromFrame, inFrame, kAxes, kFrames, stepped, type FrameName } from "./frames";
import type { Mover } from "./mover";
import { TeachView } from "./teach_view";

const kRefreshMs = 100;
const kSteps: [string, number][] = [["continuous", 0], ["0.1 mm · 0.1°", 0.0001], ["1 mm · 1°", 0.001], ["10 mm · 5°", 0.01], ["50 mm · 15°", 0.05]];
const kDegrees: Record<number, number> = { 0.0001: 0.1, 0.001: 1, 0.01: 5, 0.05: 15 };
const kHeldAheadS = 0.25; // a held button aims so far ahead, and stops so soon
const kHoldMs = 50;
const kPointKept = "visum.point.";
const kDegree = Math.PI / 180;

export class ToolPane {
  readonly arm = new Signal<Arm | null>(null);
  readonly usable = new Signal<boolean>(false); // isUsable, as shown last
  readonly element = h("section", { class: "tool", "aria-label": "Tool" });
  readonly handles = h("select", { "aria-label": "Handles in the view" }, h("option", { value: "translate" }, "move"), h("option", { value: "rotate" }, "turn"), h("option", { value: "off" }, "none"));
  private readonly choice = h("select", { "aria-label": "Body that is moved" });
  private readonly point = ["x", "y", "z"].map((axis) => h("input", { type: "number", step: 0.001, value: "0", "aria-label": `${axis} of the point that moves, in the body's frame, m`, title: "The point that moves, in the body's frame, m" }));
  private readonly frame = h("select", { "aria-label": "Frame" }, ...kFrames.map((name) => h("option", { value: name }, name)));
  private readonly step = h("select", { "aria-label": "Step" }, ...kSteps.map(([name, value]) => h("option", { value, selected: value === 0.01 }, name)));
  private readonly take = h("button", { type: "button", class: "primary take" });
  private readonly fields: HTMLInputElement[];
  private readonly controls: (HTMLInputElement | HTMLButtonElement)[];
  private typing: HTMLInputElement | null = null; // the field that a user is at; the others follow the tool
  private readonly notice = h("span", {});
  private readonly hurry = h("button", { type: "button", class: "small", onclick: () => void this.arm.value?.hurry().catch(reportError) }, "Full speed");
  private readonly teach: TeachView;

  constructor(private readonly link: Link, private readonly world: World, private readonly parts: Parts, readonly mover: Mover) {
    this.fields = kAxes.map((axis, i) => this.field(axis, i));
    const jogs = kAxes.flatMap((axis, i) => [this.jog(axis, i, -1), this.jog(axis, i, 1)]);
    this.controls = [...this.fields, ...jogs];
    this.teach = new TeachView(world, this.arm, mover);
    const rows = kAxes.map((axis, i) => h("div", { class: "jog-row" }, h("span", { class: "jog-axis" }, axis), jogs[2 * i]!, this.fields[i]!, h("span", { class: "unit" }, i < 3 ? "m" : "°"), jogs[2 * i + 1]!));
    this.element.append(
      h("div", { class: "tool-choices" }, field("Moves", this.choice), h("div", { class: "field tool-point", role: "group", "aria-label": "Point that moves" }, h("span", {}, "its point"), ...this.point), field("Frame", this.frame), field("Step", this.step), field("Handles", this.handles)),
      h("div", { class: "jog-rows", role: "group", "aria-label": "Coordinates of the tool" }, ...rows, h("p", { class: "jog-hint" }, "Type a coordinate and press Enter: the tool moves there.")),
      h("div", { class: "tool-notice", role: "status" }, this.notice, this.hurry), this.take, this.teach.element);
    this.choice.addEventListener("change", () => this.use(this.choice.value));
    for (const input of this.point) input.addEventListener("change", () => this.movePoint());
    this.take.addEventListener("click", () => void this.arm.value?.part.acquire().catch(reportError));
    mover.stopped.on((why) => report(`The tool stops: ${why}`, "error"));
    // A description comes before the poses that belong to it
    let known = world.description.value;
    world.sampled.on(() => {
      if (known === world.description.value) return;
      known = world.description.value;
      this.offer();
    });
    setInterval(() => this.refresh(), kRefreshMs);
  }

  get isUsable(): boolean {
    return this.holds && hindrance(this.arm.value!.part) === "";
  }

  private get holds(): boolean {
    return this.arm.value !== null && this.arm.value.part.leased.value && this.link.mayCommand;
  }

  get inToolFrame(): boolean {
    return this.frame.value === "tool";
  }

  // The pose of the base in the world's frame.
  basePose(): Pose {
    const { sample } = this.world;
    const arm = this.arm.value;
    return bodyPose(sample!, arm ? this.world.bodyIndex(arm.base) : -1);
  }

  private offer(): void {
    const description = this.world.description.value;
    const bodies = description ? tools(description, this.parts) : [];
    const before = this.choice.value;
    this.choice.replaceChildren(...bodies.map((name) => h("option", { value: name }, name)));
    this.use(bodies.includes(before) ? before : (bodies[0] ?? ""));
  }

  // The browser keeps the point for each body of a scene.
  private get pointKey(): string {
    return `${kPointKept}${this.world.description.value?.scene ?? ""}.${this.choice.value}`;
  }
  private get keptPoint(): Vector {
    const numbers = (localStorage.getItem(this.pointKey) ?? "").split(" ").map(Number);
    return numbers.length === 3 && numbers.every(Number.isFinite) ? (numbers as Vector) : [0, 0, 0];
  }

  private movePoint(): void {
    localStorage.setItem(this.pointKey, this.point.map((input) => input.valueAsNumber || 0).join(" "));
    this.use(this.choice.value);
  }

  private use(body: string): void {
    const { sample } = this.world;
    const description = this.world.description.value;
    this.choice.value = body;
    const point = this.keptPoint;
    this.point.forEach((input, i) => (input.value = String(point[i])));
    const arm = description && sample && body !== "" ? armOf(description, sample, this.parts, body, point) : null;
    this.mover.use(arm);
    this.arm.value = arm;
  }

  private field(axis: string, index: number): HTMLInputElement {
    const input = h("input", { type: "number", step: "any", "aria-label": `${axis} of the tool, ${index < 3 ? "m" : "degrees"}` });
    // It is left alone from when it is entered. A new value would take the selection away, and what is typed
    // would be appended.
    const begin = () => (this.typing = input);
    for (const event of ["focus", "pointerdown", "input"]) input.addEventListener(event, begin);
    input.addEventListener("keydown", ({ key }) => key !== "Enter" && begin());
    // Then it shows where the tool is; the others may be selected by now
    const end = () => {
      if (this.typing === input) this.typing = null;
      this.show([input]);
    };
    input.addEventListener("change", () => {
      if (Number.isFinite(input.valueAsNumber)) this.goTyped(index, input.valueAsNumber);
      end();
    });
    input.addEventListener("blur", end);
    input.addEventListener("keyup", ({ key }) => key === "Enter" && end());
    return input;
  }

  // The other coordinates are those of the goal on the way to it, so that several may be typed one after the
  // other while the tool moves.
  private goTyped(index: number, value: number): void {
    const from = this.mover.target();
    if (!from || !this.isUsable) return;
    const values = this.coordinates(from);
    values[index] = value;
    const [x, y, z, ...turns] = values as [number, number, number, number, number, number];
    const shown: Pose = { position: [x, y, z], orientation: fromRpy(turns.map((angle) => angle * kDegree) as Vector) };
    this.mover.go(fromFrame(shown, this.basePose(), this.frame.value as FrameName));
  }

  // As the fields show a pose of the base's frame: m and degrees.
  private coordinates(pose: Pose): number[] {
    const shown = inFrame(pose, this.basePose(), this.frame.value as FrameName);
    return [...shown.position, ...toRpy(shown.orientation).map((angle) => angle / kDegree)];
  }

  private jog(axis: string, index: number, sign: number): HTMLButtonElement {
    const button = h("button", { type: "button", class: "small jog", "aria-label": `Tool ${axis} ${sign < 0 ? "less" : "more"}` }, sign < 0 ? "−" : "+");
    let holding = 0;
    const move = (by: number) => {
      const from = this.mover.commanded();
      if (from && this.isUsable) this.mover.go(stepped(from, this.basePose(), this.frame.value as FrameName, index, sign * by));
    };
    const press = () => {
      const size = Number(this.step.value);
      if (size > 0) return move(index < 3 ? size : kDegrees[size]! * kDegree);
      const { metresPerS, radiansPerS } = this.mover.speeds;
      const ahead = kHeldAheadS * (index < 3 ? metresPerS : radiansPerS);
      move(ahead);
      clearInterval(holding);
      holding = window.setInterval(() => move(ahead), kHoldMs);
    };
    const release = () => {
      if (holding === 0) return;
      clearInterval(holding);
      holding = 0;
      this.mover.halt();
    };
    button.addEventListener("pointerdown", press);
    for (const end of ["pointerup", "pointercancel", "pointerleave", "blur"]) button.addEventListener(end, release);
    button.addEventListener("keydown", (event) => [" ", "Enter"].includes(event.key) && !event.repeat && press());
    button.addEventListener("keyup", release);
    return button;
  }

  private refresh(): void {
    const arm = this.arm.value;
    const usable = (this.usable.value = this.isUsable);
    if (!arm || !this.world.sample || document.hidden || this.element.offsetParent === null) return;
    for (const control of this.controls) if (control.disabled === usable) control.disabled = !usable;
    this.take.hidden = this.holds;
    this.showNotice(arm);
    this.take.disabled = !this.link.mayCommand;
    setText(this.take, `Take control of ${arm.part.name}`);
    this.teach.enable(usable);
    this.show(this.fields.filter((input) => input !== this.typing));
  }

  private show(inputs: readonly HTMLInputElement[]): void {
    const arm = this.arm.value;
    if (!arm || !this.world.sample) return;
    const numbers = this.coordinates(this.actual(arm));
    this.fields.forEach((input, i) => {
      if (inputs.includes(input)) input.value = asShown(numbers[i]!, i < 3 ? 4 : 2);
    });
  }

  // Why the arm does not move, or moves slower than a user expects.
  private showNotice(arm: Arm): void {
    const hindered = hindrance(arm.part);
    const [slow] = hindered === "" ? arm.slowed() : [];
    setText(this.notice, hindered !== "" ? `${hindered}.` : slow ? `${slow.description.name} is ${formatValue(arm.part.commanded(slow))} ${slow.description.unit}: the tool is slow.` : "");
    this.hurry.hidden = !slow;
    this.hurry.disabled = !this.usable.value;
  }

  // Where the tool is, by the world itself, in the base's frame.
  private actual(arm: Arm): Pose {
    const point: Pose = { position: arm.point, orientation: [1, 0, 0, 0] };
    return fromFrame(compose(bodyPose(this.world.sample!, this.world.bodyIndex(arm.tool)), point), this.basePose(), "world");
  }
}

// Without the sign of what rounds to zero or to half a turn, which would change all the time.
function asShown(value: number, digits: number): string {
  return value.toFixed(digits).replace(/^-(?=[0.]*$|180\.00$)/, "");
}

function field(name: string, input: HTMLElement): HTMLElement {
  return h("label", { class: "field" }, h("span", {}, name), input);
}
