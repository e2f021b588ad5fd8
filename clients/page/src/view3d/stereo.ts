// Two pictures for two eyes, with off-axis frusta. Both eyes look in parallel through one window, the screen,
// so that a point in its plane is at the same place for both. Side by side, one above the other, or red and
// cyan.
import {
  HalfFloatType, Mesh, OrthographicCamera, PerspectiveCamera, PlaneGeometry, Scene, ShaderMaterial, Vector2, WebGLRenderTarget,
  type WebGLRenderer,
} from "three";

export type StereoMode = "off" | "side-by-side" | "top-bottom" | "anaglyph";
export interface StereoSettings {
  mode: StereoMode;
  eyes: number; // distance of the eyes, m
  screen: number; // distance of the screen, where both pictures agree, m
  swapped: boolean; // the eyes change places
}

// The frustum of an eye at `offset` to the right of the middle: the edges of the near plane. Pure.
export function eyeFrustum(fovDegrees: number, aspect: number, near: number, offset: number, screen: number) {
  const top = near * Math.tan((fovDegrees * Math.PI) / 360);
  const shift = (-offset * near) / screen;
  return { left: -aspect * top + shift, right: aspect * top + shift, top, bottom: -top };
}

function eyeCamera(middle: PerspectiveCamera, offset: number, screen: number, aspect: number): PerspectiveCamera {
  const eye = middle.clone();
  eye.translateX(offset);
  eye.updateMatrixWorld();
  const { left, right, top, bottom } = eyeFrustum(middle.fov, aspect, middle.near, offset, screen);
  eye.projectionMatrix.makePerspective(left, right, top, bottom, middle.near, middle.far, middle.coordinateSystem);
  eye.projectionMatrixInverse.copy(eye.projectionMatrix).invert();
  return eye;
}

// For the left and the right picture.
export function eyeCameras(middle: PerspectiveCamera, { eyes, screen, swapped }: StereoSettings): [PerspectiveCamera, PerspectiveCamera] {
  const half = (swapped ? -eyes : eyes) / 2;
  return [eyeCamera(middle, -half, screen, middle.aspect), eyeCamera(middle, half, screen, middle.aspect)];
}

// A picture of the view: its camera, and its place in shares of the view, from the upper left corner.
export interface Picture {
  camera: PerspectiveCamera;
  x: number;
  y: number;
  width: number;
  height: number;
}

// One picture, or one for each eye, the left eye's first. Each half holds the whole window, squeezed; the
// display stretches it again.
export function picturesOf(camera: PerspectiveCamera, settings: StereoSettings): Picture[] {
  const whole = { camera, x: 0, y: 0, width: 1, height: 1 };
  if (settings.mode === "off" || settings.mode === "anaglyph") return [whole];
  const half = settings.mode === "side-by-side" ? { width: 0.5 } : { height: 0.5 };
  const [left, right] = eyeCameras(camera, settings);
  return [{ ...whole, ...half, camera: left }, { ...whole, ...half, camera: right, ...("width" in half ? { x: 0.5 } : { y: 0.5 }) }];
}

export function drawStereo(renderer: WebGLRenderer, scene: Scene, camera: PerspectiveCamera, settings: StereoSettings): void {
  if (settings.mode === "off") renderer.render(scene, camera);
  else if (settings.mode === "anaglyph") drawAnaglyph(renderer, scene, eyeCameras(camera, settings));
  else drawHalves(renderer, scene, picturesOf(camera, settings));
}

function drawHalves(renderer: WebGLRenderer, scene: Scene, pictures: Picture[]): void {
  const size = renderer.getSize(new Vector2());
  renderer.setScissorTest(true);
  for (const { camera, x, y, width, height } of pictures) {
    // Y upwards
    const place = [x * size.x, (1 - y - height) * size.y, width * size.x, height * size.y] as const;
    renderer.setViewport(...place);
    renderer.setScissor(...place);
    renderer.render(scene, camera);
  }
  renderer.setScissorTest(false);
  renderer.setViewport(0, 0, size.x, size.y);
}

const quad = new Mesh(
  new PlaneGeometry(2, 2),
  new ShaderMaterial({
    uniforms: { left: { value: null }, right: { value: null } },
    vertexShader: "varying vec2 at; void main() { at = uv; gl_Position = vec4(position.xy, 0.0, 1.0); }",
    // The red comes from the left eye's brightness, so that red things are not dark for the other eye.
    fragmentShader: `uniform sampler2D left; uniform sampler2D right; varying vec2 at;
      void main() {
        vec3 l = texture2D(left, at).rgb;
        vec3 r = texture2D(right, at).rgb;
        gl_FragColor = vec4(dot(l, vec3(0.299, 0.587, 0.114)), r.g, r.b, 1.0);
        #include <tonemapping_fragment>
        #include <colorspace_fragment>
      }`,
    depthTest: false,
  }),
);
const flat = new OrthographicCamera(-1, 1, 1, -1, 0, 1);
const quadScene = new Scene().add(quad);
// linear, and brighter than white if needed
const eyeTarget = () => new WebGLRenderTarget(1, 1, { samples: 4, type: HalfFloatType });
let targets: [WebGLRenderTarget, WebGLRenderTarget] | null = null;

function drawAnaglyph(renderer: WebGLRenderer, scene: Scene, eyes: [PerspectiveCamera, PerspectiveCamera]): void {
  const size = renderer.getDrawingBufferSize(new Vector2());
  targets ??= [eyeTarget(), eyeTarget()];
  targets.forEach((target, i) => {
    target.setSize(size.x, size.y);
    renderer.setRenderTarget(target);
    renderer.clear();
    renderer.render(scene, eyes[i]!);
  });
  renderer.setRenderTarget(null);
  const uniforms = (quad.material as ShaderMaterial).uniforms;
  uniforms["left"]!.value = targets[0].texture;
  uniforms["right"]!.value = targets[1].texture;
  renderer.render(quadScene, flat);
}
