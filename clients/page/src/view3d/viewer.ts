// The 3D view. It draws the world only if the world or the camera has moved.
import { ACESFilmicToneMapping, Box3, Color, PCFSoftShadowMap, Raycaster, Scene, Sphere, Vector2, Vector3, WebGLRenderer } from "three";
import type { WorldDescription } from "../link/messages";
import { Emitter } from "../common/signal";
import type { World } from "../model/world";
import { report, reportError } from "../ui/toasts";
import { Bodies } from "./bodies";
import { ViewCamera } from "./camera";
import { Lights } from "./lights";
import { Resolution } from "./resolution";
import { drawStereo, picturesOf, type Picture, type StereoSettings } from "./stereo";

const kMostPixelRatio = 2;
const kExposure = 1.05;
const kDarkExposure = 0.42;
// m, rad, or of a quaternion: a body held by its drives trembles less, and needs no new picture. The arm
// trembles by up to 3e-5 where a drive hunts for an increment of its encoder.
export const kInvisible = 1e-4;

export class Viewer {
  readonly canvas: HTMLCanvasElement;
  readonly scene = new Scene();
  readonly bodies: Bodies;
  readonly view: ViewCamera;
  readonly renderer: WebGLRenderer;
  readonly drawn = new Emitter<number>(); // after each picture: its number
  readonly rebuilt = new Emitter<WorldDescription>();
  readonly beforeDraw = new Emitter<void>(); // for overlays, when the poses are placed
  readonly stereo: StereoSettings = { mode: "off", eyes: 0.065, screen: 1.5, swapped: false };
  followed = ""; // the body's name; numbers change when bodies come or go
  private readonly lights = new Lights();
  private readonly resolution = new Resolution();
  private poses = new Float64Array(0);
  private shown = new Float64Array(0);
  private dirty = true;
  private pictures = 0;
  private framed = ""; // the scene that the camera was set up for
  private unlit = false; // the world has no light yet
  private built: WorldDescription | null = null;

  constructor(container: HTMLElement, private readonly world: World) {
    this.renderer = new WebGLRenderer({ antialias: true, powerPreference: "high-performance" });
    this.renderer.shadowMap.enabled = true;
    this.renderer.shadowMap.type = PCFSoftShadowMap;
    this.renderer.shadowMap.autoUpdate = false;
    this.renderer.toneMapping = ACESFilmicToneMapping;
    this.canvas = this.renderer.domElement;
    this.canvas.tabIndex = 0;
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", "3D view of the world. Arrow keys orbit, Shift with arrow keys pans, plus and minus zoom.");
    container.prepend(this.canvas);
    this.bodies = new Bodies(world, (words) => report(words, "error"));
    this.view = new ViewCamera(this.canvas, () => this.redraw());
    this.scene.add(this.bodies.root, this.lights.root);
    new ResizeObserver(() => this.resize(container)).observe(container);
    this.resize(container);
    world.description.watch((description) => description && this.rebuild(description).catch(reportError));
    requestAnimationFrame((now) => this.frame(now));
  }

  // False while the poses still belong to the bodies of the world before.
  get isUpToDate(): boolean {
    return this.built !== null && this.built === this.world.description.value;
  }

  redraw(): void {
    this.dirty = true;
  }

  // `dark`: for a page in dark colours, whose view would glare otherwise.
  setLook(sky: string, dark: boolean): void {
    this.scene.background = new Color(sky);
    this.renderer.toneMappingExposure = dark ? kDarkExposure : kExposure;
    this.redraw();
  }

  // A point of the world in pixels of the page, as seen by one eye in the middle. Null behind the camera.
  toPixels(point: Vector3): { x: number; y: number } | null {
    return this.inPicture(point, { camera: this.view.camera, x: 0, y: 0, width: 1, height: 1 });
  }

  // The same in each picture of the view: one, or one for each eye.
  toAllPixels(point: Vector3): { x: number; y: number }[] {
    return picturesOf(this.view.camera, this.stereo).flatMap((picture) => this.inPicture(point, picture) ?? []);
  }

  // The ray from the eye through a pixel of the page, in the present picture.
  rayAt(clientX: number, clientY: number): Raycaster {
    const { left, top, width, height } = this.canvas.getBoundingClientRect();
    const [x, y] = [(clientX - left) / width, (clientY - top) / height];
    const pictures = picturesOf(this.view.camera, this.stereo);
    const picture = pictures.find((one) => x < one.x + one.width && y < one.y + one.height) ?? pictures.at(-1)!;
    const ray = new Raycaster();
    ray.setFromCamera(new Vector2((2 * (x - picture.x)) / picture.width - 1, 1 - (2 * (y - picture.y)) / picture.height), picture.camera);
    return ray;
  }

  private inPicture(point: Vector3, picture: Picture): { x: number; y: number } | null {
    const p = point.clone().project(picture.camera);
    if (p.z > 1) return null;
    const { left, top, width, height } = this.canvas.getBoundingClientRect();
    return {
      x: left + (picture.x + ((p.x + 1) / 2) * picture.width) * width,
      y: top + (picture.y + ((1 - p.y) / 2) * picture.height) * height,
    };
  }

  // A picture of the present view, as it is on the screen.
  toBlob(): Promise<Blob | null> {
    this.usePixels(1);
    this.draw();
    return new Promise((resolve) => this.canvas.toBlob(resolve, "image/png"));
  }

  private async rebuild(description: WorldDescription): Promise<void> {
    // New poses do not belong to the bodies that are still there
    this.poses = this.shown = new Float64Array(0);
    if (!(await this.bodies.build(description))) return;
    this.built = description;
    this.unlit = true;
    this.poses = new Float64Array(7 * description.bodies.length);
    this.shown = new Float64Array(this.poses.length).fill(NaN);
    this.rebuilt.emit(description);
    this.redraw();
  }

  private frame(now: number): void {
    requestAnimationFrame((next) => this.frame(next));
    if (this.world.posesAt(now, this.poses) && this.moved()) {
      this.bodies.place(this.poses);
      this.shown.set(this.poses);
      this.renderer.shadowMap.needsUpdate = true;
      this.redraw();
      if (this.unlit) this.light();
    }
    const share = this.resolution.frame(now, this.dirty);
    if (share === null) return;
    this.usePixels(share);
    this.dirty = false;
    const followed = this.bodies.groups.find(({ name }) => name === this.followed);
    this.view.follow(followed ? followed.position : null);
    this.draw();
    this.drawn.emit(++this.pictures);
  }

  // Before the first picture the shown poses are NaN, and no number is near NaN.
  private moved(): boolean {
    return this.poses.some((value, i) => !(Math.abs(value - this.shown[i]!) <= kInvisible));
  }

  private usePixels(share: number): void {
    const ratio = share * Math.min(window.devicePixelRatio, kMostPixelRatio);
    if (this.renderer.getPixelRatio() !== ratio) this.renderer.setPixelRatio(ratio);
  }

  private draw(): void {
    this.beforeDraw.emit();
    drawStereo(this.renderer, this.scene, this.view.camera, this.stereo);
  }

  // Home shows everything except endless scenery. So does the first look at a scene.
  private light(): void {
    this.unlit = false;
    const sphere = this.extent();
    this.lights.build(this.built?.lights ?? [], Math.max(0.5, sphere.radius + sphere.center.length()));
    this.view.setHome(sphere);
    const scene = this.built?.scene ?? "";
    if (this.framed !== scene) this.view.goHome();
    this.framed = scene;
  }

  private extent(): Sphere {
    const box = new Box3();
    this.bodies.shapes.flat().forEach(({ mesh, shape }) => {
      if (shape.kind !== "plane" && mesh.visible) box.expandByObject(mesh);
    });
    for (const { body, pose } of this.built?.sensors ?? []) {
      const [x = 0, y = 0, z = 0] = pose;
      const carrier = this.bodies.groups.find(({ name }) => name === body);
      const at = new Vector3(x, y, z);
      box.expandByPoint(carrier ? carrier.localToWorld(at) : at);
    }
    return box.isEmpty() ? new Sphere(new Vector3(), 1) : box.getBoundingSphere(new Sphere());
  }

  private resize(container: HTMLElement): void {
    const { clientWidth: width, clientHeight: height } = container;
    if (width === 0 || height === 0) return;
    this.renderer.setSize(width, height);
    this.view.resize(width / height);
    this.redraw();
  }
}
