// The bodies of a second recording that are visibly elsewhere than in the one that is shown, drawn as ghosts.
import { Group, Mesh, type Matrix4, type MeshStandardMaterial } from "three";
import type { WorldDescription } from "../link/messages";
import { apartInWords, isToBeSeen } from "../model/beside";
import type { Recording } from "../model/recording";
import type { World } from "../model/world";
import { h, setText } from "../ui/dom";
import { addGhostShapes } from "./ghost_shapes";
import type { Viewer } from "./viewer";

const kNamed = 3; // bodies

export class BesideGhost {
  readonly sign = h("p", { class: "ghost-sign", hidden: true });
  private readonly root = new Group();
  private groups: Group[] = []; // by body
  private poses = new Float64Array(0);
  private on = true;

  constructor(private readonly viewer: Viewer, private readonly world: World, private readonly recording: Recording) {
    viewer.scene.add(this.root);
    viewer.rebuilt.on((description) => this.build(description));
    viewer.beforeDraw.on(() => this.place());
    recording.bodies.changed.on(() => {
      this.tell();
      viewer.redraw();
    });
    recording.report.watch(() => this.tell());
  }

  set(on: boolean): void {
    this.on = on;
    this.tell();
    this.viewer.redraw();
  }

  // The matrix from the frame of a body's ghost to the world; null: the body has no ghost now.
  matrixOf(body: number): Matrix4 | null {
    const group = this.groups[body];
    return this.root.visible && group?.visible ? group.matrixWorld : null;
  }

  private build(description: WorldDescription): void {
    this.root.traverse((object) => object instanceof Mesh && (object.material as MeshStandardMaterial).dispose());
    this.root.clear();
    this.groups = [];
    if (!this.recording.report.value?.beside) return;
    this.poses = new Float64Array(7 * description.bodies.length);
    this.groups = description.bodies.map((_, body) => {
      const group = new Group();
      addGhostShapes(this.viewer.bodies.shapes[body] ?? [], group);
      return group;
    });
    for (const group of this.groups) this.root.add(group);
  }

  private place(): void {
    const { apart } = this.recording.bodies;
    this.root.visible = this.on && apart.length === this.groups.length && this.recording.bodies.posesAt(this.world.shownMs, this.poses);
    if (!this.root.visible) return;
    this.groups.forEach((group, i) => {
      group.visible = isToBeSeen(apart[i]!);
      const at = 7 * i;
      group.position.set(this.poses[at]!, this.poses[at + 1]!, this.poses[at + 2]!);
      group.quaternion.set(this.poses[at + 4]!, this.poses[at + 5]!, this.poses[at + 6]!, this.poses[at + 3]!);
      group.updateMatrixWorld(true);
    });
  }

  private tell(): void {
    const beside = this.recording.report.value?.beside;
    const { apart, position } = this.recording.bodies;
    this.sign.hidden = !this.on || !beside || position < 0;
    if (!beside || this.sign.hidden) return;
    const names = this.world.description.value?.bodies.map(({ name }) => name) ?? [];
    const over = position > beside.ticks ? ", which has ended" : "";
    setText(this.sign, `Ghost: B, ${beside.file}${over}: ${apartInWords(names, apart, kNamed)}`);
  }
}
