// window.visum: the page's interface for tests and for users' own scripts.
import { Vector3 } from "three";
import type { Parts } from "./model/parts";
import type { Recording } from "./model/recording";
import type { World } from "./model/world";
import type { SceneView } from "./view3d/scene_view";

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
  // The place of a body's point in the page, in pixels. The point is in the body's frame (m); without it, the
  // body's origin. Null: behind the camera.
  project(body: string, point?: [number, number, number]): { x: number; y: number } | null;
  // The same for the body's ghost: in the other arm of a mirrored pair, or in a second recording. Null also
  // if the body has no ghost.
  projectGhost(body: string, point?: [number, number, number]): { x: number; y: number } | null;
  // The camera's position and target (m, world frame), and its vertical angle of view (degrees).
  camera(): { position: number[]; target: number[]; fov: number };
  simTime(): number; // s
  shownTime(): number; // s: of the picture, which follows a moment later; without one, as simTime()
  // The position for which the bodies of a second recording, beside the one that is shown, are known: in
  // ticks since the beginning; -1: none.
  besidePosition(): number;
}

export function makeApi(parts: Parts, world: World, recording: Recording, view: SceneView | null): VisumApi {
  const port = (part: string, name: string) => {
    const found = parts.port(part, name);
    if (!found) throw new Error(`part '${part}' has no port '${name}'`);
    return found;
  };
  const partOf = (name: string) => {
    const found = parts.find(name);
    if (!found) throw new Error(`there is no part '${name}'`);
    return found;
  };
  const shown = () => {
    if (!view) throw new Error("this browser draws no 3D");
    return view;
  };
  const simTime = () => Number(world.sample?.simTimeNs ?? 0n) / 1e9;
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
      const { viewer } = shown();
      const group = viewer.bodies.groups[world.bodyIndex(body)];
      if (!group) throw new Error(`there is no body '${body}'`);
      return viewer.toPixels(group.localToWorld(new Vector3(...point)));
    },
    projectGhost: (body, point = [0, 0, 0]) => {
      const { viewer, ghost, beside } = shown();
      const matrix = ghost.matrixOf(world.bodyIndex(body)) ?? beside.matrixOf(world.bodyIndex(body));
      return matrix && viewer.toPixels(new Vector3(...point).applyMatrix4(matrix));
    },
    camera: () => {
      const { camera, controls } = shown().viewer.view;
      return { position: camera.position.toArray(), target: controls.target.toArray(), fov: camera.fov };
    },
    simTime,
    shownTime: () => (view ? world.shownMs / 1e3 : simTime()),
    besidePosition: () => recording.bodies.position,
  };
}

declare global {
  interface Window {
    visum: VisumApi;
  }
}
