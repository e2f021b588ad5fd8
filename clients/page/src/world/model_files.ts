// The files of a model that this page sends to the server, and where the model goes. Pure.

export interface Sent {
  path: string;
  content: Uint8Array<ArrayBuffer>;
}

const kModels = /\.(urdf|sdf|mjcf|xml|ya?ml)$/i;
const kOthers = /\.(xacro|stl|obj|dae|mtl|png|jpe?g)$/i;

// A file that may be a model by itself.
export const isModel = (path: string): boolean => kModels.test(path) && !path.split("/").some((word) => word.startsWith("."));
// A file that a model may name.
export const isOfModel = (path: string): boolean => isModel(path) || kOthers.test(path);

// "x, y, z" in m, or "x, y, z, turn" with a turn about z in degrees, as a pose of the protocol. Throws if it
// is neither.
export function poseOf(text: string): number[] {
  const numbers = text.split(/[\s,]+/).filter(Boolean).map(Number);
  if ((numbers.length !== 3 && numbers.length !== 4) || !numbers.every(Number.isFinite))
    throw new Error("The place must be x, y, z in m; a fourth number is the turn about z in degrees");
  const half = ((numbers[3] ?? 0) * Math.PI) / 360;
  return [...numbers.slice(0, 3), Math.cos(half), 0, 0, Math.sin(half)];
}
