// The places of a model's links, computed from its URDF alone. Tests compare the page with them.
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { source } from "./programs.mjs";

const numbers = (text) => (text ?? "0 0 0").trim().split(/\s+/).map(Number);
const attribute = (xml, element, name) => new RegExp(`<${element}\\b[^>]*\\b${name}="([^"]*)"`).exec(xml)?.[1];

function readJoints(urdf) {
  const joints = readFileSync(urdf, "utf8").matchAll(/<joint name="([^"]*)" type="([^"]*)">([\s\S]*?)<\/joint>/g);
  return [...joints].map(([, name, type, xml]) => ({
    name, type,
    parent: attribute(xml, "parent", "link"),
    child: attribute(xml, "child", "link"),
    xyz: numbers(attribute(xml, "origin", "xyz")),
    rpy: numbers(attribute(xml, "origin", "rpy")),
    axis: numbers(attribute(xml, "axis", "xyz")),
  }));
}

export const readArm = () => readJoints(join(source, "models/amtec_arm/amtec_arm.urdf"));

// Rodrigues' formula: the rotation by `angle` about the unit vector `axis`, as rows.
function turn([x, y, z], angle) {
  const c = Math.cos(angle), s = Math.sin(angle), t = 1 - c;
  return [
    [t * x * x + c, t * x * y - s * z, t * x * z + s * y],
    [t * x * y + s * z, t * y * y + c, t * y * z - s * x],
    [t * x * z - s * y, t * y * z + s * x, t * z * z + c],
  ];
}
const times = (a, b) => a.map((row) => b[0].map((_, j) => row.reduce((sum, value, k) => sum + value * b[k][j], 0)));
const apply = (a, v) => a.map((row) => row.reduce((sum, value, k) => sum + value * v[k], 0));

// The position of each link's frame by name, with the model's root at the world's origin. Revolute joints
// only.
export function linkPositions(joints, angles) {
  const frames = new Map([[joints[0].parent, { rotation: turn([0, 0, 1], 0), position: [0, 0, 0] }]]);
  for (const { name, type, parent, child, xyz, rpy: [roll, pitch, yaw], axis } of joints) {
    const from = frames.get(parent);
    if (!from || type !== "revolute") continue;
    const fixed = times(times(turn([0, 0, 1], yaw), turn([0, 1, 0], pitch)), turn([1, 0, 0], roll));
    const moved = apply(from.rotation, xyz);
    frames.set(child, {
      rotation: times(from.rotation, times(fixed, turn(axis, angles[name]))),
      position: from.position.map((value, i) => value + moved[i]),
    });
  }
  return new Map([...frames].map(([link, { position }]) => [link, position]));
}
