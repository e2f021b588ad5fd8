// The camera: orbit, pan and zoom by mouse, touch and keys; follow a body; look from a viewpoint.
import { PerspectiveCamera, Sphere, Vector3 } from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { distanceToSee } from "./framing";

const kOrbitStep = Math.PI / 36;
const kZoomStep = 1.1;
const kPanShare = 0.04; // of the distance
const kHomeFov = 40; // degrees
const kHomeDirection = new Vector3(0.62, -0.68, 0.42).normalize();

export interface Viewpoint {
  name: string;
  position: [number, number, number];
  target: [number, number, number];
  fov: number; // degrees, vertical
}

export class ViewCamera {
  readonly camera = new PerspectiveCamera(kHomeFov, 1, 0.01, 200);
  readonly controls: OrbitControls;
  private subject = new Sphere(new Vector3(0.3, 0, 0.35), 1); // what Home shows
  private isHome = true; // nobody has moved the camera since
  private followed: Vector3 | null = null;

  constructor(canvas: HTMLElement, onChange: () => void) {
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = false;
    this.controls.minDistance = 0.05;
    this.controls.maxDistance = 80;
    this.controls.addEventListener("change", onChange);
    this.controls.addEventListener("start", () => (this.isHome = false));
    canvas.addEventListener("keydown", (event) => this.onKey(event));
    canvas.addEventListener("wheel", () => (this.isHome = false));
    this.goHome();
  }

  // `subject`: all that Home shows, in the world's frame.
  setHome(subject: Sphere): void {
    this.subject = subject;
  }
  goHome(): void {
    const { center, radius } = this.subject;
    const position = center.clone().addScaledVector(kHomeDirection, distanceToSee(radius, kHomeFov, this.camera.aspect));
    this.look({ name: "Home", position: position.toArray(), target: center.toArray(), fov: kHomeFov });
    this.isHome = true;
  }

  look(viewpoint: Viewpoint): void {
    this.isHome = false;
    this.camera.position.set(...viewpoint.position);
    this.controls.target.set(...viewpoint.target);
    this.camera.fov = viewpoint.fov;
    this.camera.updateProjectionMatrix();
    this.controls.update();
  }

  // Where it stands and looks, as look() takes it.
  get place(): Omit<Viewpoint, "name"> {
    return { position: this.camera.position.toArray(), target: this.controls.target.toArray(), fov: this.camera.fov };
  }

  resize(aspect: number): void {
    this.camera.aspect = aspect;
    this.camera.updateProjectionMatrix();
    if (this.isHome) this.goHome(); // all of it still fits
  }

  // Moves along with a point from call to call; null: stands still.
  follow(point: Vector3 | null): void {
    if (point) this.isHome = false;
    if (point && this.followed) {
      const step = point.clone().sub(this.followed);
      if (step.lengthSq() > 0) {
        this.camera.position.add(step);
        this.controls.target.add(step);
        this.controls.update();
      }
    }
    this.followed = point ? point.clone() : null;
  }

  private onKey(event: KeyboardEvent): void {
    const act = this.actionFor(event);
    if (!act) return;
    event.preventDefault();
    if (event.key !== "Home") this.isHome = false;
    act();
    this.controls.update();
  }

  private actionFor({ key, shiftKey }: KeyboardEvent): (() => void) | null {
    const x = key === "ArrowRight" ? 1 : key === "ArrowLeft" ? -1 : 0;
    const y = key === "ArrowUp" ? 1 : key === "ArrowDown" ? -1 : 0;
    if (x !== 0 || y !== 0) return () => (shiftKey ? this.pan(x, y) : this.orbit(x, y));
    if (key === "+" || key === "=") return () => this.zoom(1 / kZoomStep);
    if (key === "-") return () => this.zoom(kZoomStep);
    return key === "Home" ? () => this.goHome() : null;
  }

  private orbit(x: number, y: number): void {
    const arm = this.camera.position.clone().sub(this.controls.target);
    arm.applyAxisAngle(this.camera.up, x * kOrbitStep);
    const side = new Vector3().crossVectors(this.camera.up, arm).normalize();
    const lifted = arm.clone().applyAxisAngle(side, -y * kOrbitStep);
    const angle = lifted.angleTo(this.camera.up);
    if (angle > 0.05 && angle < Math.PI - 0.05) arm.copy(lifted);
    this.camera.position.copy(this.controls.target).add(arm);
  }

  private pan(x: number, y: number): void {
    const step = kPanShare * this.camera.position.distanceTo(this.controls.target);
    const right = new Vector3().setFromMatrixColumn(this.camera.matrix, 0).multiplyScalar(x * step);
    const up = new Vector3().setFromMatrixColumn(this.camera.matrix, 1).multiplyScalar(y * step);
    for (const vector of [right, up]) {
      this.camera.position.add(vector);
      this.controls.target.add(vector);
    }
  }

  private zoom(factor: number): void {
    const arm = this.camera.position.clone().sub(this.controls.target).multiplyScalar(factor);
    this.camera.position.copy(this.controls.target).add(arm);
  }
}
