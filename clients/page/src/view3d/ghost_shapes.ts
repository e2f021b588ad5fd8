// Translucent copies of a body's shapes, for what is elsewhere in another world.
import { Color, Mesh, MeshStandardMaterial, type Group } from "three";
import { isDrawn, type ShapeObject } from "./bodies";

const kColor = new Color(0x009e73);
const kOpacity = 0.45;

// The copies use the geometries of the body, which disposes of them; the materials are their own.
export function addGhostShapes(shapes: readonly ShapeObject[], group: Group): void {
  for (const { mesh, shape } of shapes) {
    if (!isDrawn(shape)) continue;
    const copy = new Mesh(mesh.geometry, new MeshStandardMaterial({ color: kColor, transparent: true, opacity: kOpacity, depthWrite: false }));
    copy.position.copy(mesh.position);
    copy.quaternion.copy(mesh.quaternion);
    copy.raycast = () => undefined;
    group.add(copy);
  }
}
