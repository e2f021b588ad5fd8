// The ports that drive a body: those of the joint that carries it. A part's ports come in the order of its
// joints. In a group of angles only hinges count, in a group of lengths only sliders.
import type { JointDescription } from "../link/messages";
import type { Port } from "../model/part";
import type { Parts } from "../model/parts";
import type { World } from "../model/world";

export function drivingPorts(world: World, parts: Parts, body: string): string[] {
  const joints = world.description.value?.joints ?? [];
  const joint = joints.find(({ child, part }) => child === body && part !== "");
  const part = joint && parts.find(joint.part);
  if (!joint || !part) return [];
  const inputs = part.ports.filter((port) => port.side === "input");
  const mine = portsOfJoint(joint, joints.filter((other) => other.part === joint.part && other.type !== "fixed"), inputs);
  return [`${joint.name} of part ${part.name}`, ...mine.map((port) => port.description.name)];
}

// Pure.
export function portsOfJoint(joint: JointDescription, ofPart: readonly JointDescription[], ports: readonly Port[]): Port[] {
  const groups = new Map<string, Port[]>();
  for (const port of ports) groups.set(port.description.group, [...(groups.get(port.description.group) ?? []), port]);
  const alike = ofPart.filter(({ type }) => type === joint.type);
  return [...groups.values()].flatMap((group) => {
    if (group.length < 2) return [];
    const typed = group.filter((port) => fits(port.description.unit, joint.type));
    const found = typed.length === alike.length ? typed[alike.indexOf(joint)] : undefined;
    return found ? [found] : [];
  });
}

function fits(unit: string, type: string): boolean {
  return type === "slider" ? unit === "m" || unit.startsWith("m/") : unit.startsWith("rad");
}
