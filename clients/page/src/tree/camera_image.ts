// A camera's blackboard as a picture (server/scene/README.md describes its bytes). Pure.

export interface CameraImage {
  width: number;
  height: number;
  rgba: Uint8ClampedArray<ArrayBuffer>;
  takenS: number; // simulated
}

export const kCameraType = "application/x-visum-image";
const kLeastHeader = 24;
const kBytesPerPixel = [3, 4, 2]; // colours, depths, bodies
const kOpaque = 255;

// Null: there is no picture yet, or this page does not know its kind.
export function decodeCamera(bytes: Uint8Array): CameraImage | null {
  if (bytes.byteLength < kLeastHeader) return null;
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  const [header, width, height, shows] = [0, 4, 8, 12].map((at) => view.getUint32(at, true)) as [number, number, number, number];
  const takenNs = view.getBigInt64(16, true);
  const pixels = width * height;
  const perPixel = kBytesPerPixel[shows];
  if (takenNs < 0n || perPixel === undefined || bytes.byteLength < header + pixels * perPixel) return null;
  const colorOf = [colors, depths, segments][shows]!(view, header, pixels);
  const rgba = new Uint8ClampedArray(4 * pixels);
  for (let i = 0; i < pixels; ++i) {
    rgba.set(colorOf(i), 4 * i);
    rgba[4 * i + 3] = kOpaque;
  }
  return { width, height, rgba, takenS: Number(takenNs) / 1e9 };
}

type ColorOf = (pixel: number) => [number, number, number];

function colors(view: DataView, at: number): ColorOf {
  return (i) => [view.getUint8(at + 3 * i), view.getUint8(at + 3 * i + 1), view.getUint8(at + 3 * i + 2)];
}

// The nearest depth is white, the furthest one black.
function depths(view: DataView, at: number, pixels: number): ColorOf {
  let [least, most] = [Infinity, 0];
  for (let i = 0; i < pixels; ++i) {
    const depth = view.getFloat32(at + 4 * i, true);
    least = Math.min(least, depth);
    most = Math.max(most, depth);
  }
  return (i) => {
    const gray = most > least ? (255 * (most - view.getFloat32(at + 4 * i, true))) / (most - least) : 0;
    return [gray, gray, gray];
  };
}

// Each body has a colour, far from the colours of the bodies with near numbers. Nothing is black.
function segments(view: DataView, at: number): ColorOf {
  return (i) => {
    const body = view.getUint16(at + 2 * i, true);
    return body === 0 ? [0, 0, 0] : [64 + ((body * 97) % 192), 64 + ((body * 57) % 192), 64 + ((body * 151) % 192)];
  };
}
