// The other arm of a mirrored pair, drawn as a ghost of the arm in this world.
import { Group, Matrix4, Mesh, type MeshStandardMaterial } from "three";
import type { WorldDescription } from "../link/messages";
import type { Part } from "../model/part";
import type { Parts } from "../model/parts";
import type { World } from "../model/world";
import { h, setText } from "../ui/dom";
import { divergencePorts, ghostBodies, ghostPose, type GhostBody } from "./ghost_pose";
import { addGhostShapes } from "./ghost_shapes";
import { kInvisible, type Viewer } from "./viewer";

const kKind = "divergence"; // the kind of the part that tells how far two arms are apart (visum-mirror)
const kSuffix = "_divergence"; // its name is the arm's name with this suffix

export class Ghost {
  readonly sign = h("p", { class: "ghost-sign", hidden: true });
  private readonly root = new Group();
  private groups: Group[] = []; // by body; empty for a body without a ghost
  private bodies: GhostBody[] = [];
  private ports: number[] = []; // by joint: the output that tells how far it is apart
  private part: Part | null = null;
  private placed: number[] = []; // the values that it was last drawn with
  private on = true;
  private stop: () => void = () => undefined;

  constructor(private readonly viewer: Viewer, private readonly world: World, private readonly parts: Parts) {
    viewer.scene.add(this.root);
    viewer.rebuilt.on((description) => this.build(description));
    parts.list.watch(() => this.world.description.value && this.build(this.world.description.value));
    viewer.beforeDraw.on(() => this.place());
  }

  set(on: boolean): void {
    this.on = on;
    this.viewer.redraw();
  }

  // The matrix from the frame of a body's ghost to the world; null: the body has no ghost.
  matrixOf(body: number): Matrix4 | null {
    return this.bodies.some((ghost) => ghost.body === body) ? this.groups[body]!.matrixWorld : null;
  }

  private build(description: WorldDescription): void {
    this.stop();
    this.clear();
    this.part = this.parts.list.value.find(({ description: { kind } }) => kind === kKind) ?? null;
    if (!this.part || this.viewer.bodies.groups.length !== description.bodies.length) return;
    const arm = this.part.name.endsWith(kSuffix) ? this.part.name.slice(0, -kSuffix.length) : "";
    this.bodies = ghostBodies(description.joints, arm, (name) => this.world.bodyIndex(name));
    this.ports = divergencePorts(description.joints, arm, this.part.description.sensorOutputs);
    this.groups = description.bodies.map(() => new Group());
    for (const { body } of this.bodies) addGhostShapes(this.viewer.bodies.shapes[body]!, this.groups[body]!);
    for (const group of this.groups) this.root.add(group);
    this.stop = this.part.sampled.on(() => this.moved() && this.viewer.redraw());
  }

  // The geometries belong to the bodies, which dispose of them.
  private clear(): void {
    this.root.traverse((object) => object instanceof Mesh && (object.material as MeshStandardMaterial).dispose());
    this.root.clear();
    this.bodies = [];
    this.groups = [];
  }

  private place(): void {
    const joints = this.world.description.value?.joints ?? [];
    const shown = this.viewer.bodies.groups;
    this.placed = this.state();
    const side = this.side();
    this.root.visible = this.on && side !== 0 && this.bodies.length > 0;
    this.tell(side);
    if (!this.root.visible || shown.length !== this.groups.length) return;
    for (const { body, joint, parent } of this.bodies) {
      const apart = side * this.value(this.ports[joint]!);
      const parentShown = shown[parent]?.matrixWorld ?? new Matrix4();
      const parentGhost = this.matrixOf(parent) ?? parentShown;
      const group = this.groups[body]!;
      group.matrixAutoUpdate = false;
      group.matrix.copy(ghostPose(joints[joint]!, apart, parentGhost, parentShown, shown[body]!.matrixWorld));
      group.updateMatrixWorld(true);
    }
  }

  private state(): number[] {
    return [this.side(), ...this.ports.map((port) => this.value(port))];
  }

  // An arm held by its drives trembles. A movement too small to see needs no new picture.
  private moved(): boolean {
    const now = this.state();
    return now.length !== this.placed.length || now.some((value, i) => !(Math.abs(value - this.placed[i]!) <= kInvisible));
  }

  // The ports tell how far the shadow is from the primary. Returns +1 if this world is the primary's, -1 if
  // it is the shadow's, and 0 if nothing is known of the other arm.
  private side(): number {
    const [of, primary] = [this.read("World Of"), this.read("Primary")];
    const connected = this.read("Connected 1") === 1 && this.read("Connected 2") === 1;
    if (!(of > 0) || !connected) return 0;
    return of === primary ? 1 : -1;
  }

  private tell(side: number): void {
    this.sign.hidden = !this.part || !this.on;
    if (this.sign.hidden) return;
    const far = (this.read("Largest Angle Divergence") * 180) / Math.PI;
    setText(this.sign, side === 0 ? "The other arm is not connected" : `Ghost: the ${side > 0 ? "shadow" : "primary"} arm, ${far.toFixed(1)}° apart`);
  }

  private value(port: number): number {
    const value = this.part?.sample?.sensorOutputs[port];
    return value === undefined || Number.isNaN(value) ? 0 : value;
  }
  private read(name: string): number {
    const port = this.part?.port(name);
    return port && this.part ? this.part.value(port) : NaN;
  }
}
