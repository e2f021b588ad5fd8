// Overlays of the world: frames, centres of mass, joint axes with their angles, contacts with their forces,
// trails, and what sensors see. They are drawn through bodies, so that nothing hides them.
import { ArrowHelper, AxesHelper, Group, Mesh, MeshBasicMaterial, Quaternion, SphereGeometry, Vector3 } from "three";
import type { JointDescription, WorldDescription } from "../link/messages";
import type { World } from "../model/world";
import { formatInRange } from "../ui/numbers";
import { disposeOf } from "./dispose";
import type { BesideGhost } from "./beside_ghost";
import type { Ghost } from "./ghost";
import { Labels } from "./labels";
import { onTop } from "./on_top";
import type { SensorOverlay } from "./sensors";
import { Trails } from "./trails";
import type { Viewer } from "./viewer";

export const kOverlays = {
  frames: "Frames of bodies",
  com: "Centres of mass",
  joints: "Joint axes and angles",
  contacts: "Contacts and forces",
  trails: "Trails",
  collision: "Collision shapes",
  rays: "Sensor rays",
  cameras: "Camera frusta",
  ghost: "The other arm of a mirrored pair",
  beside: "The second recording",
} as const;
export type OverlayName = keyof typeof kOverlays;

const kAxisLength = 0.12; // m
const kArrowMetresPerNewton = 0.004;
const kLongestArrow = 0.5;

export class Overlays {
  readonly on: Record<OverlayName, boolean> = {
    frames: false, com: false, joints: false, contacts: false, trails: false, collision: false, rays: false, cameras: false, ghost: true, beside: true,
  };
  private readonly root = new Group();
  private readonly contacts = new Group();
  private readonly labels: Labels;
  private frames: AxesHelper[] = [];
  private centres: Mesh[] = [];
  private axes: { arrow: ArrowHelper; joint: JointDescription; parent: number; child: number; index: number }[] = [];
  private readonly trails = new Trails();

  constructor(private readonly viewer: Viewer, private readonly world: World, private readonly sensors: SensorOverlay, private readonly ghosts: { ghost: Ghost; beside: BesideGhost }, container: HTMLElement) {
    this.labels = new Labels(container, viewer);
    viewer.scene.add(this.root, this.contacts, this.trails.root, sensors.root);
    viewer.rebuilt.on((description) => this.build(description));
    viewer.beforeDraw.on(() => this.place());
  }

  set(name: OverlayName, on: boolean): void {
    this.on[name] = on;
    if (name === "rays") this.sensors.showRays(on);
    if (name === "cameras") this.sensors.showFrusta(on);
    if (name === "ghost" || name === "beside") this.ghosts[name].set(on);
    if (name === "collision") this.viewer.bodies.showCollisionShapes(on);
    if (name === "trails" && !on) this.trails.forget();
    this.viewer.redraw();
  }

  private build(description: WorldDescription): void {
    disposeOf(this.root);
    this.root.clear();
    this.frames = description.bodies.map(() => onTop(new AxesHelper(kAxisLength)));
    this.centres = description.bodies.map(() => onTop(new Mesh(new SphereGeometry(0.012, 12, 8), new MeshBasicMaterial({ color: 0xb0499a }))));
    const bodyOf = (name: string) => description.bodies.findIndex((body) => body.name === name);
    this.axes = description.joints.map((joint, index) => ({
      joint, index, parent: bodyOf(joint.parent), child: bodyOf(joint.child),
      arrow: arrow(joint.type === "slider" ? 0x009e73 : 0x0072b2),
    }));
    this.trails.build(description);
    this.root.add(...this.frames, ...this.centres, ...this.axes.map(({ arrow }) => arrow));
    this.sensors.build(description);
    this.viewer.bodies.showCollisionShapes(this.on.collision);
  }

  private place(): void {
    const description = this.world.description.value;
    const groups = this.viewer.bodies.groups;
    if (!description || groups.length !== description.bodies.length || this.frames.length !== groups.length) return;
    groups.forEach((group, i) => {
      const body = description.bodies[i]!;
      const frame = this.frames[i]!;
      frame.visible = this.on.frames;
      frame.position.copy(group.position);
      frame.quaternion.copy(group.quaternion);
      const centre = this.centres[i]!;
      centre.visible = this.on.com && !body.fixed;
      const [x = 0, y = 0, z = 0] = body.com;
      centre.position.set(x, y, z).applyMatrix4(group.matrixWorld);
    });
    this.placeAxes();
    this.placeContacts();
    this.trails.root.visible = this.on.trails;
    if (this.on.trails) this.trails.extend(groups, this.world.sample?.era);
    this.sensors.place();
  }

  private placeAxes(): void {
    const texts: { at: Vector3; text: string }[] = [];
    for (const { arrow, joint, parent, index } of this.axes) {
      arrow.visible = this.on.joints && joint.type !== "fixed";
      if (!arrow.visible) continue;
      const [x = 0, y = 0, z = 0, qw = 1, qx = 0, qy = 0, qz = 0] = joint.pose;
      const [ax = 0, ay = 0, az = 1] = joint.axis;
      const at = new Vector3(x, y, z);
      const axis = new Vector3(ax, ay, az).applyQuaternion(new Quaternion(qx, qy, qz, qw));
      const group = this.viewer.bodies.groups[parent];
      if (group) at.applyMatrix4(group.matrixWorld), axis.applyQuaternion(group.quaternion);
      arrow.position.copy(at);
      arrow.setDirection(axis);
      const value = this.world.sample?.jointPositions[index] ?? NaN;
      const text = joint.type === "slider" ? `${formatInRange(value * 1000, 0, 200, "mm")} mm` : `${formatInRange((value * 180) / Math.PI, 0, 360, "°")}°`;
      texts.push({ at: at.addScaledVector(axis, 1.3 * kAxisLength), text });
    }
    this.labels.show(texts);
  }

  private placeContacts(): void {
    this.contacts.visible = this.on.contacts;
    if (!this.on.contacts) return;
    const samples = this.world.sample?.contacts ?? [];
    while (this.contacts.children.length < samples.length) this.contacts.add(arrow(0xd55e00));
    this.contacts.children.forEach((child, i) => {
      const contact = samples[i];
      child.visible = contact !== undefined;
      if (!contact) return;
      const [px = 0, py = 0, pz = 0] = contact.position;
      const [nx = 0, ny = 0, nz = 1] = contact.normal;
      child.position.set(px, py, pz);
      (child as ArrowHelper).setDirection(new Vector3(nx, ny, nz));
      const length = Math.min(kLongestArrow, 0.03 + kArrowMetresPerNewton * contact.normalForceN);
      (child as ArrowHelper).setLength(length, 0.025, 0.016);
    });
  }
}

function arrow(color: number): ArrowHelper {
  const made = new ArrowHelper(new Vector3(0, 0, 1), new Vector3(), kAxisLength, color, 0.03, 0.018);
  onTop(made.line);
  onTop(made.cone);
  return made;
}
