// Draws the view of sensors: the rays of distance sensors, by their own readings, and the space in a camera's
// picture. They move with the body that carries the sensor.
import { BufferGeometry, Float32BufferAttribute, Group, LineBasicMaterial, LineSegments, Points, PointsMaterial } from "three";
import type { SensorDescription, WorldDescription } from "../link/messages";
import type { Part } from "../model/part";
import type { Parts } from "../model/parts";
import type { World } from "../model/world";
import { reportError } from "../ui/toasts";
import { disposeOf } from "./dispose";
import { onTop } from "./on_top";
import { frustumEdges, hits, type Point } from "./sight";
import type { Viewer } from "./viewer";

const kRayColor = 0x56b4e9;
const kFrustumColor = 0xe69f00;
const kHitPixels = 5;
const kNear = 0.25; // m; the frame of a camera's picture is drawn here
const kRefreshMs = 50;

interface Sight {
  sensor: SensorDescription;
  place: Group;
  rays: LineSegments;
  hits: Points;
  shown: number; // `Changed` of the reading that is drawn
  reading: boolean;
}

export class SensorOverlay {
  readonly root = new Group();
  private sights: Sight[] = [];
  private rays = false;
  private frusta = false;

  constructor(private readonly viewer: Viewer, private readonly world: World, private readonly parts: Parts) {
    setInterval(() => this.rays && !document.hidden && this.refresh(), kRefreshMs);
  }

  showRays(on: boolean): void {
    this.rays = on;
    this.refresh();
  }
  showFrusta(on: boolean): void {
    this.frusta = on;
  }

  build(description: WorldDescription): void {
    disposeOf(this.root);
    this.sights = description.sensors.filter(({ range }) => range.length > 0).map(sightOf);
    this.root.clear();
    for (const { place } of this.sights) this.root.add(place);
  }

  place(): void {
    for (const { sensor, place } of this.sights) {
      place.visible = sensor.kind === "camera" ? this.frusta : this.rays;
      if (!place.visible) continue;
      const [x = 0, y = 0, z = 0, qw = 1, qx = 0, qy = 0, qz = 0] = sensor.pose;
      place.position.set(x, y, z);
      place.quaternion.set(qx, qy, qz, qw);
      const carrier = this.viewer.bodies.groups[this.world.bodyIndex(sensor.body)];
      if (!carrier) continue; // the sensor is fixed to the world
      place.position.applyMatrix4(carrier.matrixWorld);
      place.quaternion.premultiply(carrier.quaternion);
    }
  }

  private refresh(): void {
    for (const sight of this.sights) {
      const part = this.parts.find(sight.sensor.part);
      const changed = part?.port("Changed");
      const now = part && changed ? part.value(changed) : NaN;
      if (!part || sight.sensor.kind === "camera" || sight.reading || !(now > 0) || now === sight.shown) continue;
      sight.reading = true;
      read(part, sight.sensor)
        .then((distances) => this.show(sight, now, hits(sight.sensor, distances)), reportError)
        .finally(() => (sight.reading = false));
    }
  }

  private show(sight: Sight, shown: number, ends: readonly Point[]): void {
    sight.shown = shown;
    setPoints(sight.rays.geometry, ends.flatMap((end): Point[] => [[0, 0, 0], end]));
    setPoints(sight.hits.geometry, ends);
    this.viewer.redraw();
  }
}

function sightOf(sensor: SensorDescription): Sight {
  const camera = sensor.kind === "camera";
  const lines = (color: number, opacity: number) => new LineSegments(new BufferGeometry(), new LineBasicMaterial({ color, opacity, transparent: opacity < 1 }));
  // A fan has many rays. Each of them is faint, and the points that they hit stand out.
  const rays = onTop(camera ? lines(kFrustumColor, 1) : lines(kRayColor, sensor.kind === "scanner" ? 0.3 : 1));
  const ends = onTop(new Points(new BufferGeometry(), new PointsMaterial({ color: kRayColor, size: kHitPixels, sizeAttenuation: false })));
  setPoints(rays.geometry, camera ? frustumEdges(sensor, kNear) : []);
  setPoints(ends.geometry, []);
  const place = new Group();
  place.add(rays, ends);
  for (const object of [rays, ends]) object.frustumCulled = false; // their bounds change with each reading
  return { sensor, place, rays, hits: ends, shown: 0, reading: false };
}

function setPoints(geometry: BufferGeometry, points: readonly Point[]): void {
  geometry.setAttribute("position", new Float32BufferAttribute(points.flat(), 3));
}

// One ray is a port; many rays are a blackboard of 32-bit floats.
async function read(part: Part, { kind }: SensorDescription): Promise<ArrayLike<number>> {
  const port = part.port("Distance");
  if (kind === "distance" && port) return [part.value(port)];
  const { data } = await part.readBlackboard("scan");
  return new Float32Array(data.slice().buffer);
}
