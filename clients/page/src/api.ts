// window.visum: what tests and users' own scripts need of the page.
import { Vector3 } from "three";
import type { Parts } from "./model/parts";
import type { World } from "./model/world";
import type { Ghost } from "./view3d/ghost";
import type { Viewer } from "./view3d/viewer";

export interface PortInfo {
  part: string;
  port: string;
  side: "input" | "output";
  unit: string;
  minimum: number;
  maximum: number;
  value: number;
}

export interface VisumApi {
  ports(): PortInfo[];
  read(part: string, port: string): number; // the latest value; NaN before the first sample
  write(part: string, port: string, value: number): Promise<void>; // needs the lease
  acquire(part: string): Promise<void>;
  release(part: string): Promise<void>;
  bodies(): string[];
  // Where a point of a body (m, in its frame; none: its origin) is in the page, in pixels; null: behind the camera.
  project(body: string, point?: [number, number, number]): { x: number; y: number } | null;
  // The same of the ghost: the other arm of a mirrored pair; null, too: that body has none.
  projectGhost(body: string, point?: [number, number, number]): { x: number; y: number } | null;
  // Where the world is seen from: m, in the world's frame; the vertical angle of view in degrees.
  camera(): { position: number[]; target: number[]; fov: number };
  simTime(): number; // s
}

export function makeApi(parts: Parts, world: World, viewer: Viewer, ghost: Ghost): VisumApi {
  const port = (part: string, name: string) => {
    const found = parts.port(part, name);
    if (!found) throw new Error(`there is no port '${name}' of a part '${part}'`);
    return found;
  };
  const partOf = (name: string) => {
    const found = parts.find(name);
    if (!found) throw new Error(`there is no part '${name}'`);
    return found;
  };
  return {
    ports: () => parts.list.value.flatMap((part) => part.ports.map((entry) => {
      const { name, unit, minimum, maximum } = entry.description;
      return { part: part.name, port: name, side: entry.side, unit, minimum, maximum, value: part.value(entry) };
    })),
    read: (part, name) => partOf(part).value(port(part, name)),
    write: (part, name, value) => partOf(part).write(port(part, name), value),
    acquire: (part) => partOf(part).acquire(),
    release: (part) => partOf(part).release(),
    bodies: () => world.description.value?.bodies.map(({ name }) => name) ?? [],
    project: (body, point = [0, 0, 0]) => {
      const group = viewer.bodies.groups[world.bodyIndex(body)];
      if (!group) throw new Error(`there is no body '${body}'`);
      return viewer.toPixels(group.localToWorld(new Vector3(...point)));
    },
    projectGhost: (body, point = [0, 0, 0]) => {
      const matrix = ghost.matrixOf(world.bodyIndex(body));
      return matrix && viewer.toPixels(new Vector3(...point).applyMatrix4(matrix));
    },
    camera: () => {
      const { camera, controls } = viewer.view;
      return { position: camera.position.toArray(), target: controls.target.toArray(), fov: camera.fov };
    },
    simTime: () => Number(world.sample?.simTimeNs ?? 0n) / 1e9,
  };
}

declare global {
  interface Window {
    visum: VisumApi;
  }
}
