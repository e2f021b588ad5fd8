// Pulls a body by a spring that the server computes (PullBody), while a hand holds it. A line from the body
// to a dot at the hand shows the pull.
import { BufferGeometry, Float32BufferAttribute, Line, LineBasicMaterial, Mesh, MeshBasicMaterial, Plane, SphereGeometry, Vector3, type Raycaster } from "three";
import type { Link } from "../link/link";
import { LostError, RequestError, type BodyDescription } from "../link/messages";
import { onTop } from "./on_top";
import type { Viewer } from "./viewer";

const kPeriodMs = 50; // from one message to the next
const kHeldS = 0.5; // the pull ends so soon after the last message, should this page hang; of wall time
const kForcePerKg = 60; // N: six times the weight
const kColor = 0xd55e00;
const kHandSize = 0.009; // of the dot at the hand, as a share of its distance

interface Held {
  name: string;
  body: number;
  local: Vector3; // the point held, in the body's frame
  plane: Plane; // the hand moves in it
  target: Vector3;
  mostN: number;
  timer: number;
}

export class Pull {
  private held: Held | null = null;
  private asking = false;
  private readonly line = onTop(new Line(new BufferGeometry(), new LineBasicMaterial({ color: kColor })));

  private readonly hand = onTop(new Mesh(new SphereGeometry(1, 16, 8), new MeshBasicMaterial({ color: kColor })));

  // `failed` gets why the server does not pull.
  // `speed` tells how fast the world runs.
  constructor(private readonly viewer: Viewer, private readonly link: Link, private readonly speed: () => number, private readonly failed: (error: unknown) => void) {
    this.line.visible = this.hand.visible = false;
    this.line.frustumCulled = false;
    viewer.scene.add(this.line, this.hand);
    viewer.beforeDraw.on(() => this.draw());
  }

  get isPulling(): boolean {
    return this.held !== null;
  }

  // `point`: in the world. It can be moved in the plane that faces the camera.
  begin(body: number, { name, massKg }: BodyDescription, point: Vector3): void {
    this.end();
    const normal = this.viewer.view.camera.getWorldDirection(new Vector3());
    this.held = {
      name, body, local: this.viewer.bodies.groups[body]!.worldToLocal(point.clone()), plane: new Plane().setFromNormalAndCoplanarPoint(normal, point),
      target: point.clone(), mostN: Math.max(1, kForcePerKg * massKg), timer: window.setInterval(() => void this.send(), kPeriodMs),
    };
    void this.send();
    this.viewer.redraw();
  }

  moveTo(ray: Raycaster): void {
    if (!this.held) return;
    ray.ray.intersectPlane(this.held.plane, this.held.target);
    this.viewer.redraw();
  }

  end(): void {
    if (!this.held) return;
    clearInterval(this.held.timer);
    const { name } = this.held;
    this.held = null;
    this.viewer.redraw();
    // It would end by itself a moment later: an error here says nothing new
    this.link.request({ case: "releaseBody", value: { body: name } }, "ok").catch(() => undefined);
  }

  private async send(): Promise<void> {
    if (this.asking || !this.held) return;
    this.asking = true;
    const { name, local, target, mostN } = this.held;
    const durationNs = BigInt(Math.round(1e9 * kHeldS * Math.max(1, this.speed())));
    const value = { body: name, pointM: local.toArray(), targetM: target.toArray(), maxForceN: mostN, durationNs };
    try {
      await this.link.request({ case: "pullBody", value }, "ok");
    } catch (error) {
      if (this.held?.name === name) this.end();
      if (error instanceof RequestError || !(error instanceof LostError)) this.failed(error);
    } finally {
      this.asking = false;
    }
  }

  private draw(): void {
    const group = this.held && this.viewer.bodies.groups[this.held.body];
    this.line.visible = this.hand.visible = !!group;
    if (!this.held || !group) return;
    this.hand.position.copy(this.held.target);
    this.hand.scale.setScalar(kHandSize * this.held.target.distanceTo(this.viewer.view.camera.position));
    const from = group.localToWorld(this.held.local.clone());
    this.line.geometry.setAttribute("position", new Float32BufferAttribute([...from.toArray(), ...this.held.target.toArray()], 3));
  }
}
