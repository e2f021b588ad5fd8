// A chain of joints from a base to a tool: where the tool is for given joint values, and how it moves with
// each joint. Pure.
import { aboutAxis, add, compose, cross, kIdentity, rotate, scale, subtract, type Pose, type Vector } from "./pose";

export interface ChainJoint {
  name: string;
  slides: boolean; // else it turns
  frame: Pose; // of the joint, in the link before it
  axis: Vector; // unit, in the joint's frame
  lower: number; // m or rad
  upper: number;
  child: Pose; // of the link behind it, in the moved joint's frame; mostly the identity
}

// The pose of the tool in the base's frame.
export function forward(joints: readonly ChainJoint[], values: ArrayLike<number>): Pose {
  return joints.reduce((pose, joint, i) => compose(compose(compose(pose, joint.frame), motion(joint, values[i]!)), joint.child), kIdentity);
}

// For each joint how the tool moves with it: its origin (m per m or rad), and how it turns (rad per m or
// rad), in the base's frame.
export function jacobian(joints: readonly ChainJoint[], values: ArrayLike<number>): { linear: Vector; angular: Vector }[] {
  const axes: { at: Vector; axis: Vector }[] = [];
  let pose = kIdentity;
  joints.forEach((joint, i) => {
    const frame = compose(pose, joint.frame);
    axes.push({ at: frame.position, axis: rotate(frame.orientation, joint.axis) });
    pose = compose(compose(frame, motion(joint, values[i]!)), joint.child);
  });
  return axes.map(({ at, axis }, i) =>
    joints[i]!.slides ? { linear: axis, angular: [0, 0, 0] } : { linear: cross(axis, subtract(pose.position, at)), angular: axis });
}

export function motion({ slides, axis }: Pick<ChainJoint, "slides" | "axis">, value: number): Pose {
  if (slides) return { position: add([0, 0, 0], scale(axis, value)), orientation: [1, 0, 0, 0] };
  return { position: [0, 0, 0], orientation: aboutAxis(axis, value) };
}
