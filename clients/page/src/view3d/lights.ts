// The scene's lights. A scene without lights gets those of a studio: sky, a sun with shadows, and a weak one
// from behind.
import { AmbientLight, Color, DirectionalLight, Group, HemisphereLight, PointLight, SpotLight, SRGBColorSpace, type Light, type LightShadow } from "three";
import type { LightDescription } from "../link/messages";
import { disposeOf } from "./dispose";

const kFull = 2.6; // three.js' intensity for a light that lights white paper fully, under the view's exposure

export class Lights {
  readonly root = new Group();

  // `radius`: shadows are drawn within it, around the origin, m.
  build(descriptions: readonly LightDescription[], radius: number): void {
    disposeOf(this.root);
    this.root.clear();
    if (descriptions.length === 0) this.buildStudio(radius);
    for (const description of descriptions) this.add(description, radius);
  }

  private add(description: LightDescription, radius: number): void {
    const [r = 1, g = 1, b = 1] = description.color;
    const light = lightOf(description, new Color().setRGB(r, g, b, SRGBColorSpace), radius);
    this.root.add(light);
    if (light instanceof DirectionalLight || light instanceof SpotLight) this.root.add(light.target);
  }

  private buildStudio(radius: number): void {
    this.root.add(new HemisphereLight(0xe8f1fb, 0xb8aa98, 1.25), new AmbientLight(0xffffff, 0.25));
    const sun = new DirectionalLight(0xfff4e6, 2.1);
    sun.position.set(1.6 * radius, -1.9 * radius, 3 * radius);
    castShadows(sun, radius);
    const back = new DirectionalLight(0xdfe9ff, 0.5);
    back.position.set(-2 * radius, 2 * radius, radius);
    this.root.add(sun, back);
  }
}

function lightOf(description: LightDescription, color: Color, radius: number): Light {
  const { kind, intensity, angle, shadows } = description;
  const [px = 0, py = 0, pz = 0] = description.position;
  const [dx = 0, dy = 0, dz = -1] = description.direction;
  if (kind === "ambient") return new AmbientLight(color, kFull * intensity);
  if (kind === "directional") {
    const light = new DirectionalLight(color, kFull * intensity);
    light.position.set(-4 * radius * dx, -4 * radius * dy, -4 * radius * dz);
    if (shadows) castShadows(light, radius);
    return light;
  }
  // No decay: the intensity is the same wherever the light falls.
  const light = kind === "spot" ? new SpotLight(color, kFull * intensity, 0, angle, 0.2, 0) : new PointLight(color, kFull * intensity, 0, 0);
  light.position.set(px, py, pz);
  if (light instanceof SpotLight) light.target.position.set(px + dx, py + dy, pz + dz);
  light.castShadow = shadows;
  if (shadows) setShadow(light.shadow);
  return light;
}

function castShadows(light: DirectionalLight, radius: number): void {
  light.castShadow = true;
  setShadow(light.shadow);
  const camera = light.shadow.camera;
  camera.left = camera.bottom = -1.3 * radius;
  camera.right = camera.top = 1.3 * radius;
  camera.near = 0.1;
  camera.far = 8 * radius;
}

function setShadow(shadow: LightShadow): void {
  shadow.mapSize.set(1024, 1024);
  shadow.bias = -0.0004;
  shadow.normalBias = 0.01;
}
