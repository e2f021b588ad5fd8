// Poses as in the protocol: x y z qw qx qy qz. Pure.

export type Vector = [number, number, number];
export type Quaternion = [number, number, number, number]; // w x y z
export interface Pose {
  position: Vector;
  orientation: Quaternion;
}

export const kIdentity: Pose = { position: [0, 0, 0], orientation: [1, 0, 0, 0] };

export function poseOf(numbers: ArrayLike<number>, at = 0): Pose {
  if (numbers.length < at + 7) return kIdentity;
  const n = (i: number) => numbers[at + i]!;
  return { position: [n(0), n(1), n(2)], orientation: [n(3), n(4), n(5), n(6)] };
}

export const add = (a: Vector, b: Vector): Vector => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const subtract = (a: Vector, b: Vector): Vector => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const scale = (a: Vector, by: number): Vector => [by * a[0], by * a[1], by * a[2]];
export const cross = (a: Vector, b: Vector): Vector => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const length = (a: Vector): number => Math.hypot(...a);

export function multiply([aw, ax, ay, az]: Quaternion, [bw, bx, by, bz]: Quaternion): Quaternion {
  return [
    aw * bw - ax * bx - ay * by - az * bz, aw * bx + ax * bw + ay * bz - az * by,
    aw * by - ax * bz + ay * bw + az * bx, aw * bz + ax * by - ay * bx + az * bw,
  ];
}
export const conjugate = ([w, x, y, z]: Quaternion): Quaternion => [w, -x, -y, -z];

export function rotate([w, x, y, z]: Quaternion, v: Vector): Vector {
  const u: Vector = [x, y, z];
  const t = scale(cross(u, v), 2);
  return add(add(v, scale(t, w)), cross(u, t));
}

// `axis` is a unit vector, `angle` in rad.
export function aboutAxis(axis: Vector, angle: number): Quaternion {
  const s = Math.sin(angle / 2);
  return [Math.cos(angle / 2), s * axis[0], s * axis[1], s * axis[2]];
}

export function compose(a: Pose, b: Pose): Pose {
  return { position: add(a.position, rotate(a.orientation, b.position)), orientation: multiply(a.orientation, b.orientation) };
}

export function inverse({ position, orientation }: Pose): Pose {
  const back = conjugate(orientation);
  return { position: scale(rotate(back, position), -1), orientation: back };
}

// The rotation from `from` to `to` as a vector in the frame of both: its direction is the axis, its length
// the angle, at most pi.
export function rotationBetween(from: Quaternion, to: Quaternion): Vector {
  const [w, x, y, z] = multiply(to, conjugate(from));
  const sine = Math.hypot(x, y, z);
  if (sine < 1e-12) return [0, 0, 0];
  const angle = 2 * Math.atan2(sine, Math.abs(w));
  return scale([x, y, z], ((w < 0 ? -1 : 1) * angle) / sine);
}

// Roll, pitch and yaw about the fixed axes x, y and z, in this order, as in URDF.
export function toRpy([w, x, y, z]: Quaternion): Vector {
  const sine = Math.max(-1, Math.min(1, 2 * (w * y - z * x)));
  return [Math.atan2(2 * (w * x + y * z), 1 - 2 * (x * x + y * y)), Math.asin(sine), Math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))];
}
export function fromRpy([roll, pitch, yaw]: Vector): Quaternion {
  return multiply(multiply(aboutAxis([0, 0, 1], yaw), aboutAxis([0, 1, 0], pitch)), aboutAxis([1, 0, 0], roll));
}
