// How far away a camera must be to see all of a sphere. Pure.

const kAir = 1.04; // room around it

// `fov`: the vertical angle of view, degrees. `aspect`: width of the picture by its height. The narrower of
// both angles counts. The sphere touches the cone of view, so the sine of half the angle counts, not its
// tangent.
export function distanceToSee(radius: number, fov: number, aspect: number): number {
  const vertical = (fov * Math.PI) / 360;
  const horizontal = Math.atan(Math.tan(vertical) * aspect);
  return (kAir * radius) / Math.sin(Math.min(vertical, horizontal));
}
