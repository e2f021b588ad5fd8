// Handles at the tool, in the view: arrows to drag it, rings to turn it. The arm follows as far as it
// reaches.
import { Object3D } from "three";
import { TransformControls } from "three/examples/jsm/controls/TransformControls.js";
import type { Pose } from "../kinematics/pose";
import type { World } from "../model/world";
import type { Viewer } from "../view3d/viewer";
import { fromFrame } from "./frames";
import type { ToolPane } from "./pane";

export class Gizmo {
  private readonly place = new Object3D();
  private readonly controls: TransformControls;

  constructor(private readonly viewer: Viewer, private readonly world: World, private readonly pane: ToolPane) {
    this.controls = new TransformControls(viewer.view.camera, viewer.canvas);
    this.controls.setSize(0.75);
    this.controls.attach(this.place);
    viewer.scene.add(this.place, this.controls.getHelper());
    this.controls.addEventListener("change", () => viewer.redraw());
    this.controls.addEventListener("dragging-changed", () => {
      viewer.view.controls.enabled = !this.controls.dragging;
      if (!this.controls.dragging) pane.mover.halt();
    });
    this.controls.addEventListener("objectChange", () => this.drag());
    viewer.beforeDraw.on(() => this.follow());
    pane.handles.addEventListener("change", () => viewer.redraw());
    // A world that stands still is not drawn again by itself
    for (const changed of [pane.arm, pane.usable]) changed.watch(() => viewer.redraw());
  }

  private drag(): void {
    const { position, quaternion } = this.place;
    const goal: Pose = { position: position.toArray(), orientation: [quaternion.w, quaternion.x, quaternion.y, quaternion.z] };
    this.pane.mover.go(fromFrame(goal, this.pane.basePose(), "world"), true);
  }

  // Stands at the tool, unless a hand holds it.
  private follow(): void {
    const arm = this.pane.arm.value;
    const mode = this.pane.handles.value as "off" | "translate" | "rotate";
    const on = arm !== null && mode !== "off" && this.pane.isUsable && this.viewer.isUpToDate;
    this.controls.enabled = this.controls.getHelper().visible = on;
    const body = arm && this.viewer.bodies.groups[this.world.bodyIndex(arm.tool)];
    if (mode === "off" || !on || !body || this.controls.dragging) return;
    if (this.controls.mode !== mode) this.controls.setMode(mode);
    this.controls.setSpace(this.pane.inToolFrame ? "local" : "world");
    this.place.position.set(...arm.point).applyQuaternion(body.quaternion).add(body.position);
    this.place.quaternion.copy(body.quaternion);
    this.place.updateMatrixWorld();
  }
}
