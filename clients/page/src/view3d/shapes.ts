// A shape's geometry, in its own frame: as the protocol describes it, z along the axis of what is round.
import {
  BoxGeometry, BufferAttribute, BufferGeometry, CapsuleGeometry, CylinderGeometry, PlaneGeometry, SphereGeometry,
} from "three";
import type { MeshData, ShapeDescription } from "../link/messages";

const kPlaneLength = 60; // m: what is shown of a plane that has no end

// `mesh`: for the kinds convex and mesh.
export function geometryOf(shape: ShapeDescription, mesh: MeshData | null): BufferGeometry {
  const [a = 1, b = 1, c = 1] = shape.size;
  switch (shape.kind) {
    case "box":
      return boxOf(a, b, c);
    case "sphere":
      return new SphereGeometry(a, 32, 20);
    case "cylinder":
      return new CylinderGeometry(a, a, b, 40).rotateX(Math.PI / 2);
    case "capsule":
      return new CapsuleGeometry(a, b, 12, 32).rotateX(Math.PI / 2);
    case "plane":
      return new PlaneGeometry(kPlaneLength, kPlaneLength);
    default:
      return mesh ? geometryOfMesh(mesh) : new BufferGeometry();
  }
}

// A texture goes on over a, b as on the top face; the sides, which are c high, get as much of it per metre.
function boxOf(a: number, b: number, c: number): BufferGeometry {
  const box = new BoxGeometry(a, b, c);
  const uv = box.getAttribute("uv");
  for (let i = 0; i < 8; i++) uv.setX(i, uv.getX(i) * (c / a)); // +x and -x, four corners each
  for (let i = 8; i < 16; i++) uv.setY(i, uv.getY(i) * (c / b)); // +y and -y
  return box;
}

function geometryOfMesh(mesh: MeshData): BufferGeometry {
  const indexed = new BufferGeometry();
  indexed.setAttribute("position", new BufferAttribute(new Float32Array(mesh.vertices), 3));
  indexed.setIndex(new BufferAttribute(new Uint32Array(mesh.triangles), 1));
  // Flat faces: a mesh says nothing of which edges are meant to be round.
  const flat = indexed.toNonIndexed();
  flat.computeVertexNormals();
  indexed.dispose();
  return flat;
}
