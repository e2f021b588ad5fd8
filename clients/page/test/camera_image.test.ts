import assert from "node:assert/strict";
import { test } from "node:test";
import { decodeCamera } from "../src/tree/camera_image";

function picture(shows: number, width: number, height: number, bytesPerPixel: number, fill: (view: DataView) => void, takenNs = 1_500_000_000n): Uint8Array {
  // Not where its memory begins
  const bytes = new Uint8Array(3 + 24 + width * height * bytesPerPixel).subarray(3);
  const view = new DataView(bytes.buffer, bytes.byteOffset);
  [24, width, height, shows].forEach((value, i) => view.setUint32(4 * i, value, true));
  view.setBigInt64(16, takenNs, true);
  fill(new DataView(bytes.buffer, bytes.byteOffset + 24));
  return bytes;
}

test("colours come as they are", () => {
  const image = decodeCamera(picture(0, 2, 1, 3, (view) => [10, 20, 30, 40, 50, 60].forEach((value, i) => view.setUint8(i, value))))!;
  assert.deepEqual([image.width, image.height, image.takenS], [2, 1, 1.5]);
  assert.deepEqual([...image.rgba], [10, 20, 30, 255, 40, 50, 60, 255]);
});

test("of depths the nearest is white and the furthest black", () => {
  const image = decodeCamera(picture(1, 3, 1, 4, (view) => [1, 2, 3].forEach((value, i) => view.setFloat32(4 * i, value, true))))!;
  assert.deepEqual([image.rgba[0], image.rgba[4], image.rgba[8]], [255, 128, 0]);
});

test("bodies have colours of their own, and nothing is black", () => {
  const image = decodeCamera(picture(2, 3, 1, 2, (view) => [0, 1, 2].forEach((value, i) => view.setUint16(2 * i, value, true))))!;
  assert.deepEqual([...image.rgba.subarray(0, 3)], [0, 0, 0]);
  assert.notDeepEqual([...image.rgba.subarray(4, 7)], [...image.rgba.subarray(8, 11)]);
});

test("no picture yet, a cut one, or one of another kind is none", () => {
  assert.equal(decodeCamera(picture(0, 1, 1, 3, () => undefined, -1n)), null);
  assert.equal(decodeCamera(picture(0, 2, 2, 3, () => undefined).subarray(0, 30)), null);
  assert.equal(decodeCamera(picture(7, 1, 1, 4, () => undefined)), null);
  assert.equal(decodeCamera(new Uint8Array(5)), null);
});
