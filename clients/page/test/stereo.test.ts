import assert from "node:assert/strict";
import { test } from "node:test";
import { PerspectiveCamera, Vector3 } from "three";
import { eyeCameras, eyeFrustum } from "../src/view3d/stereo";

const kSettings = { mode: "side-by-side", eyes: 0.065, screen: 1.5, swapped: false } as const;

function middleCamera(): PerspectiveCamera {
  const camera = new PerspectiveCamera(40, 1.6, 0.01, 200);
  camera.position.set(1, -2, 0.7);
  camera.up.set(0, 0, 1);
  camera.lookAt(0, 0, 0.3);
  camera.updateMatrixWorld();
  return camera;
}
// A point `depth` m in front of the middle camera, `x` to its right and `y` above.
const ahead = (camera: PerspectiveCamera, depth: number, x = 0, y = 0) => camera.localToWorld(new Vector3(x, y, -depth));
const xOf = (point: Vector3, camera: PerspectiveCamera) => point.clone().project(camera).x;
const near = (a: number, b: number) => assert.ok(Math.abs(a - b) < 1e-9, `${a} is not ${b}`);

test("both eyes look in parallel through one window", () => {
  const { left, right, top, bottom } = eyeFrustum(40, 1.6, 0.01, 0.0325, 1.5);
  near(right - left, 2 * 1.6 * top);
  near(bottom, -top);
  near((right + left) / 2, (-0.0325 * 0.01) / 1.5);
});

// Similar triangles: eyes e apart, the screen at s, a point at z. Disparity on the screen, left minus right:
// e (s/z - 1).
test("the disparity is e (s/z - 1), nothing in the plane of the screen", () => {
  const camera = middleCamera();
  const [left, right] = eyeCameras(camera, kSettings);
  const halfWidth = kSettings.screen * camera.aspect * Math.tan((20 * Math.PI) / 180);
  for (const depth of [0.5, 1, 1.5, 3, 50])
    for (const [x, y] of [[0, 0], [0.2, -0.1]] as const) {
      const point = ahead(camera, depth, x, y);
      const onScreen = (xOf(point, left) - xOf(point, right)) * halfWidth;
      near(onScreen, kSettings.eyes * (kSettings.screen / depth - 1));
      near(point.clone().project(left).y, point.clone().project(right).y); // no vertical disparity
    }
});

test("swapped eyes see what the other saw", () => {
  const camera = middleCamera();
  const plain = eyeCameras(camera, kSettings);
  const swapped = eyeCameras(camera, { ...kSettings, swapped: true });
  const point = ahead(camera, 0.8, 0.1);
  near(xOf(point, swapped[0]), xOf(point, plain[1]));
  near(xOf(point, swapped[1]), xOf(point, plain[0]));
});

test("eyes at one place see what one eye sees", () => {
  const camera = middleCamera();
  const point = ahead(camera, 0.8, 0.1, 0.2);
  for (const eye of eyeCameras(camera, { ...kSettings, eyes: 0 })) near(xOf(point, eye), xOf(point, camera));
});
