// Prepares an object for an overlay: it is drawn through everything, in its own colour, and no click finds
// it.
import type { Line, LineBasicMaterial, Mesh, Points } from "three";

export function onTop<T extends Mesh | Line | Points>(object: T): T {
  const material = object.material as LineBasicMaterial;
  material.depthTest = false;
  material.toneMapped = false; // the palette's colours, in any light
  object.renderOrder = 10;
  object.raycast = () => undefined;
  return object;
}
