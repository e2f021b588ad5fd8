// The bodies of the world as objects to draw: one group per body, moved as a whole; one mesh per shape.
import { Color, GridHelper, Group, Mesh, type MeshStandardMaterial } from "three";
import { LostError, type BodyDescription, type MeshData, type ShapeDescription, type WorldDescription } from "../link/messages";
import type { World } from "../model/world";
import { disposeOf } from "./dispose";
import { Materials } from "./materials";
import { geometryOf } from "./shapes";

const kSelected = new Color(0x2f7dd1);

export interface ShapeObject {
  mesh: Mesh;
  shape: ShapeDescription;
}

export class Bodies {
  readonly root = new Group();
  groups: Group[] = [];
  shapes: ShapeObject[][] = [];
  private selected = -1;
  private generation = 0;
  private readonly materials: Materials;

  // `tell` gets a text for each thing that a body is drawn without.
  constructor(private readonly world: World, private readonly tell: (words: string) => void) {
    this.materials = new Materials((texture) => world.texture(texture), (error) => this.leaveOut("a texture", error));
  }

  // Replaces all bodies. Resolves when the meshes are there, too; to false if a newer description came
  // before.
  async build(description: WorldDescription): Promise<boolean> {
    const generation = ++this.generation;
    const [meshes] = await Promise.all([this.fetchMeshes(description), this.materials.load(description)]);
    if (generation !== this.generation) return false;
    this.dispose();
    for (const [index, body] of description.bodies.entries()) this.addBody(index, body, meshes);
    return true;
  }

  // `poses`: seven numbers per body.
  place(poses: Float64Array): void {
    this.groups.forEach((group, i) => {
      const at = 7 * i;
      group.position.set(poses[at]!, poses[at + 1]!, poses[at + 2]!);
      group.quaternion.set(poses[at + 4]!, poses[at + 5]!, poses[at + 6]!, poses[at + 3]!);
      group.updateMatrixWorld(true);
    });
  }

  select(body: number): void {
    this.tint(this.selected, 0);
    this.selected = body;
    this.tint(body, 0.45);
  }

  // Shows the visual shapes, or the collision shapes.
  showCollisionShapes(on: boolean): void {
    for (const { mesh, shape } of this.shapes.flat()) {
      const material = mesh.material as MeshStandardMaterial;
      mesh.visible = on ? shape.collides : isDrawn(shape);
      material.wireframe = on && shape.kind !== "plane";
    }
  }

  private addBody(index: number, body: BodyDescription, meshes: Map<number, MeshData>): void {
    const group = new Group();
    group.name = body.name;
    group.userData.body = index;
    const objects = body.shapes.map((shape) => shapeObject(shape, meshes.get(shape.mesh) ?? null, this.materials));
    for (const { mesh } of objects) group.add(mesh);
    this.groups.push(group);
    this.shapes.push(objects);
    this.root.add(group);
  }

  private async fetchMeshes(description: WorldDescription): Promise<Map<number, MeshData>> {
    const wanted = new Map<number, string>(); // with the name of a body that uses it
    for (const body of description.bodies)
      for (const shape of body.shapes) if (shape.kind === "mesh" || shape.kind === "convex") wanted.set(shape.mesh, body.name);
    const meshes = new Map<number, MeshData>();
    await Promise.all([...wanted].map(async ([index, body]) => {
      try {
        meshes.set(index, await this.world.mesh(index));
      } catch (error) {
        this.leaveOut(`a mesh of '${body}'`, error);
      }
    }));
    return meshes;
  }

  // One thing fails, not the whole world. If the connection is lost, the next one brings everything.
  private leaveOut(what: string, error: unknown): void {
    if (error instanceof LostError) throw error;
    this.tell(`Drawn without ${what}: ${error instanceof Error ? error.message : String(error)}`);
  }

  private tint(body: number, intensity: number): void {
    for (const { mesh } of this.shapes[body] ?? []) {
      const material = mesh.material as MeshStandardMaterial;
      material.emissive.copy(kSelected);
      material.emissiveIntensity = intensity;
    }
  }

  private dispose(): void {
    disposeOf(this.root);
    this.root.clear();
    this.groups = [];
    this.shapes = [];
    this.selected = -1;
  }
}

export function isDrawn(shape: ShapeDescription): boolean {
  return (shape.color[3] ?? 1) > 0;
}

function shapeObject(shape: ShapeDescription, data: MeshData | null, materials: Materials): ShapeObject {
  const mesh = new Mesh(geometryOf(shape, data), materials.of(shape));
  const [x = 0, y = 0, z = 0, qw = 1, qx = 0, qy = 0, qz = 0] = shape.pose;
  mesh.position.set(x, y, z);
  mesh.quaternion.set(qx, qy, qz, qw);
  mesh.visible = isDrawn(shape);
  mesh.receiveShadow = true;
  mesh.castShadow = shape.kind !== "plane";
  if (shape.kind === "plane") mesh.add(grid());
  return { mesh, shape };
}

// Lines a metre apart give a floor its scale.
function grid(): GridHelper {
  const lines = new GridHelper(20, 20, 0x56616b, 0x7f8a94);
  lines.rotation.x = Math.PI / 2;
  lines.position.z = 0.0008;
  lines.material.transparent = true;
  lines.material.opacity = 0.55;
  lines.raycast = () => undefined;
  return lines;
}
