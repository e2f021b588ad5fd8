import assert from "node:assert/strict";
import { test } from "node:test";
import { Line, Object3D } from "three";
import type { WorldDescription } from "../src/link/messages";
import { Trails } from "../src/view3d/trails";

test("a trail ends with its era: no line goes to where the next one begins", () => {
  const trails = new Trails();
  trails.build({ bodies: [{ fixed: true }, { fixed: false }] } as unknown as WorldDescription);
  const bodies = [new Object3D(), new Object3D()];
  const points = (x: number, era: bigint) => {
    bodies[1]!.position.x = x;
    trails.extend(bodies, era);
    return (trails.root.children[0] as Line).geometry.drawRange.count;
  };
  assert.deepEqual([points(0, 1n), points(0.1, 1n), points(0.2, 1n)], [1, 2, 3]);
  assert.deepEqual([points(0.9, 2n), points(1, 2n)], [1, 2]);
});
