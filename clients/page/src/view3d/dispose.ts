// Frees what a tree of objects holds on the GPU: geometries, materials, their textures, the shadows of
// lights.
import { Light, type BufferGeometry, type Material, type Object3D, type Texture } from "three";

export function disposeOf(root: Object3D): void {
  root.traverse((object) => {
    const { geometry, material } = object as { geometry?: BufferGeometry; material?: Material & { map?: Texture | null } };
    geometry?.dispose();
    material?.map?.dispose();
    material?.dispose();
    if (object instanceof Light) object.dispose();
  });
}
