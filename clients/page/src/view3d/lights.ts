// Lights: the scene's, or where it has none, those of a studio: sky, a sun with shadows, and a weak one from behind.
import { AmbientLight, DirectionalLight, Group, HemisphereLight } from "three";

export class Lights {
  readonly root = new Group();

  // `radius`: of what shadows are to be seen of, around the origin, m.
  build(radius: number): void {
    this.root.clear();
    this.root.add(new HemisphereLight(0xe8f1fb, 0xb8aa98, 1.25));
    this.root.add(new AmbientLight(0xffffff, 0.25));
    const sun = new DirectionalLight(0xfff4e6, 2.1);
    sun.position.set(1.6 * radius, -1.9 * radius, 3 * radius);
    castShadows(sun, radius);
    const back = new DirectionalLight(0xdfe9ff, 0.5);
    back.position.set(-2 * radius, 2 * radius, radius);
    this.root.add(sun, back);
  }
}

function castShadows(light: DirectionalLight, radius: number): void {
  light.castShadow = true;
  light.shadow.mapSize.set(1024, 1024);
  light.shadow.bias = -0.0004;
  light.shadow.normalBias = 0.01;
  const camera = light.shadow.camera;
  camera.left = camera.bottom = -1.3 * radius;
  camera.right = camera.top = 1.3 * radius;
  camera.near = 0.1;
  camera.far = 8 * radius;
}

