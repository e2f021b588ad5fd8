import assert from "node:assert/strict";
import { test } from "node:test";
import { Mesh, Texture, type BufferGeometry, type Material, type MeshStandardMaterial } from "three";
import { ErrorCode, LostError, type MeshData, type WorldDescription } from "../src/link/messages";
import type { World } from "../src/model/world";
import { Bodies } from "../src/view3d/bodies";
import { refusal } from "./server";

const kTriangle = { vertices: [0, 0, 0, 1, 0, 0, 0, 1, 0], triangles: [0, 1, 2] } as unknown as MeshData;
const shape = (kind: string, mesh = 0, material = 0) => ({ kind, mesh, material, size: [1, 1, 1], color: [], pose: [] });
const kDescription = {
  materials: [{ texture: 1, textureSize: [1, 1] }],
  bodies: [
    { name: "box", shapes: [shape("box", 0, 1)] },
    { name: "large", shapes: [shape("mesh", 0)] },
    { name: "small", shapes: [shape("mesh", 1)] },
    { name: "floor", shapes: [shape("plane")] },
  ],
} as unknown as WorldDescription;

function bodiesOf(mesh: (index: number) => Promise<MeshData>) {
  const told: string[] = [];
  const texture = async () => ({ contentType: "image/png", data: new Uint8Array(3) }); // and no picture
  const bodies = new Bodies({ mesh, texture } as unknown as World, (words) => told.push(words));
  return { bodies, told };
}

test("without a picture that is none and a mesh that is refused, all the rest is drawn, and it is told", async () => {
  const { bodies, told } = bodiesOf(async (index) => {
    if (index === 0) throw refusal(ErrorCode.ERROR_TOO_LARGE, "too large");
    return kTriangle;
  });
  assert.ok(await bodies.build(kDescription));
  const corners = bodies.shapes.flat().map(({ mesh }) => mesh.geometry.getAttribute("position")?.count ?? 0);
  assert.deepEqual(corners.map((count) => count > 0), [true, false, true, true]);
  assert.deepEqual(told.map((words) => words.split(":")[0]).sort(), ["Drawn without a mesh of 'large'", "Drawn without a texture"]);
  assert.ok(told.includes("Drawn without a mesh of 'large': too large"));
});

test("where the connection is lost, what was there stays for the next one", async () => {
  let lost = false;
  const { bodies, told } = bodiesOf(async () => (lost ? Promise.reject(new LostError("gone")) : kTriangle));
  await bodies.build(kDescription);
  const before = bodies.groups;
  lost = true;
  await assert.rejects(bodies.build(kDescription), LostError);
  assert.equal(bodies.groups, before);
  assert.ok(told.every((words) => words.startsWith("Drawn without a texture")));
});

test("a build that a newer one overtook says so", async () => {
  const { bodies } = bodiesOf(async () => kTriangle);
  assert.deepEqual(await Promise.all([bodies.build(kDescription), bodies.build(kDescription)]), [false, true]);
});

test("what another world replaces is given back: geometries, materials, textures, the floor's lines", async () => {
  const { bodies } = bodiesOf(async () => kTriangle);
  await bodies.build(kDescription);
  const held = new Set<BufferGeometry | Material | Texture>();
  bodies.root.traverse((object) => {
    const { geometry, material } = object as Mesh;
    for (const one of [geometry, material as Material]) if (one) held.add(one);
  });
  const map = ((bodies.shapes[0]![0]!.mesh.material as MeshStandardMaterial).map = new Texture());
  held.add(map);
  const count = held.size;
  for (const one of held) (one as Texture).addEventListener("dispose", () => held.delete(one));
  await bodies.build(kDescription);
  assert.deepEqual([count, held.size], [11, 0]);
});
