// A jog's step in one of three frames. Pure.
import { aboutAxis, add, compose, conjugate, inverse, multiply, rotate, scale, type Pose, type Vector } from "../kinematics/pose";

export const kFrames = ["world", "base", "tool"] as const;
export type FrameName = (typeof kFrames)[number];
export const kAxes = ["x", "y", "z", "roll", "pitch", "yaw"] as const;

const kUnit: Vector[] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];

// `tool`: in the base's frame; `base`: in the world's. `by`: m, or rad for the last three axes.
export function stepped(tool: Pose, base: Pose, frame: FrameName, axis: number, by: number): Pose {
  const unit = kUnit[axis % 3]!;
  if (frame === "tool") {
    const step: Pose = axis < 3 ? { position: scale(unit, by), orientation: [1, 0, 0, 0] } : { position: [0, 0, 0], orientation: aboutAxis(unit, by) };
    return compose(tool, step);
  }
  const direction = frame === "world" ? rotate(conjugate(base.orientation), unit) : unit;
  if (axis < 3) return { ...tool, position: add(tool.position, scale(direction, by)) };
  return { ...tool, orientation: multiply(aboutAxis(direction, by), tool.orientation) };
}

// The tool's coordinates in a frame: in its own they are those of the base.
export function inFrame(tool: Pose, base: Pose, frame: FrameName): Pose {
  return frame === "world" ? compose(base, tool) : tool;
}
export function fromFrame(shown: Pose, base: Pose, frame: FrameName): Pose {
  return frame === "world" ? compose(inverse(base), shown) : shown;
}
