import assert from "node:assert/strict";
import { test } from "node:test";
import type { ShapeDescription } from "../src/link/messages";
import { geometryOf } from "../src/view3d/shapes";

test("a texture lies on every face of a box with the same size", () => {
  const size = [2, 4, 6];
  const box = geometryOf({ kind: "box", size } as ShapeDescription, null);
  const uv = box.getAttribute("uv");
  const position = box.getAttribute("position");
  // One tile of 1 m: the material repeats it 2 by 4 times over (0, 0) to (1, 1).
  for (let face = 0; face < 6; face++) {
    for (const [from, to] of [[0, 1], [0, 2]] as const) {
      const [i, k] = [4 * face + from, 4 * face + to];
      const metres = Math.hypot(position.getX(i) - position.getX(k), position.getY(i) - position.getY(k), position.getZ(i) - position.getZ(k));
      const tiles = Math.hypot(2 * (uv.getX(i) - uv.getX(k)), 4 * (uv.getY(i) - uv.getY(k)));
      assert.ok(Math.abs(tiles - metres) < 1e-6, `face ${face}: ${tiles} tiles on ${metres} m`);
    }
  }
});
