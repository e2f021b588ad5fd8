import assert from "node:assert/strict";
import { test } from "node:test";
import { corners, frustumEdges, hits } from "../src/view3d/sight";

const near = (seen: number[], wanted: number[]) =>
  assert.ok(seen.length === wanted.length && seen.every((value, i) => Math.abs(value - wanted[i]!) < 1e-12), `${seen} is not ${wanted}`);

test("one ray goes along x", () => {
  assert.deepEqual(hits({ range: [0.05, 6], angle: [] }, [2.5]), [[2.5, 0, 0]]);
});

test("a fan turns from x towards y, its first and last ray included", () => {
  const [right, ahead, left, ...more] = hits({ range: [0.05, 6], angle: [-Math.PI / 2, Math.PI / 2] }, [1, 2, 3]);
  near(right!, [0, -1, 0]);
  near(ahead!, [2, 0, 0]);
  near(left!, [0, 3, 0]);
  assert.equal(more.length, 0);
});

test("a ray that found nothing, or something too near, has no end; the others keep their angles", () => {
  const found = hits({ range: [0.05, 6], angle: [0, Math.PI] }, [6, 0.05, NaN, 4, 1]);
  near(found[0]!, [4 * Math.cos(0.75 * Math.PI), 4 * Math.sin(0.75 * Math.PI), 0]);
  near(found[1]!, [-1, 0, 0]);
  assert.equal(found.length, 2);
});

test("the corners of a picture lie at half its angle of view, and its height is by its aspect", () => {
  const [leftUp] = corners({ fov: Math.PI / 2, aspect: 4 / 3 }, 2);
  near(leftUp!, [2, 2, 1.5]);
});

test("a frustum's edges go from the eye to as far as the camera sees", () => {
  const edges = frustumEdges({ fov: Math.PI / 2, aspect: 1, range: [0, 10] }, 0.25);
  assert.equal(edges.length, 8 + 8 + 8 + 4);
  assert.equal(Math.max(...edges.map(([x]) => x)), 10);
  near(edges[1]!, [10, 10, 10]);
});
