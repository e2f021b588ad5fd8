// The paths of bodies, as lines. A path ends with its era: nothing has moved from there to where the next era
// begins.
import { BufferAttribute, BufferGeometry, Group, Line, LineBasicMaterial, type Object3D, type Vector3 } from "three";
import type { WorldDescription } from "../link/messages";
import { disposeOf } from "./dispose";
import { onTop } from "./on_top";

const kPoints = 600;
const kLeastStep = 0.002; // m

interface Trail {
  line: Line;
  body: number;
  count: number;
}

export class Trails {
  readonly root = new Group();
  private trails: Trail[] = [];
  private era: bigint | undefined;

  build(description: Pick<WorldDescription, "bodies">): void {
    disposeOf(this.root);
    this.root.clear();
    this.trails = description.bodies.flatMap((body, i) => (body.fixed ? [] : [{ line: trailLine(), body: i, count: 0 }]));
    for (const { line } of this.trails) this.root.add(line);
  }

  forget(): void {
    for (const trail of this.trails) trail.count = 0;
  }

  // Adds the present poses, in `era`.
  extend(bodies: readonly Object3D[], era: bigint | undefined): void {
    if (era !== this.era) this.forget();
    this.era = era;
    for (const trail of this.trails) extend(trail, bodies[trail.body]!.position);
  }
}

function trailLine(): Line {
  const geometry = new BufferGeometry().setAttribute("position", new BufferAttribute(new Float32Array(3 * kPoints), 3));
  const line = onTop(new Line(geometry, new LineBasicMaterial({ color: 0xb0499a })));
  line.frustumCulled = false;
  return line;
}

// Adds the body's place if it has moved. The oldest point is dropped.
function extend(trail: Trail, { x, y, z }: Vector3): void {
  const positions = trail.line.geometry.getAttribute("position") as BufferAttribute;
  const array = positions.array as Float32Array;
  const last = 3 * (trail.count - 1);
  if (trail.count > 0 && Math.hypot(array[last]! - x, array[last + 1]! - y, array[last + 2]! - z) < kLeastStep) return;
  if (trail.count === kPoints) array.copyWithin(0, 3);
  else trail.count += 1;
  array.set([x, y, z], 3 * (trail.count - 1));
  positions.needsUpdate = true;
  trail.line.geometry.setDrawRange(0, trail.count);
}
