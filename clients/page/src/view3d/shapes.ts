// A shape's geometry in its own frame, as the protocol describes it: z is the axis of round shapes.
import {
  BoxGeometry, BufferAttribute, BufferGeometry, CapsuleGeometry, CylinderGeometry, PlaneGeometry, SphereGeometry,
} from "three";
import type { MeshData, ShapeDescription } from "../link/messages";

const kPlaneLength = 60; // m; the shown part of an endless plane

// `mesh` is for the kinds convex and mesh.
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

// The texture covers a times b on the top face. The sides, c high, get as much of it per metre.
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
  // Flat faces: a mesh does not say which edges are meant to be round.
  const flat = indexed.toNonIndexed();
  flat.computeVertexNormals();
  indexed.dispose();
  return flat;
}
