// A chain of driven joints that carries a body: what a user drags, jogs and teaches.
import { compose, inverse, kIdentity, poseOf, type Pose, type Vector } from "../kinematics/pose";
import { forward, motion, type ChainJoint } from "../kinematics/chain";
import { solve, type InverseOptions, type Solution } from "../kinematics/inverse";
import type { JointDescription, WorldDescription, WorldSample } from "../link/messages";
import { neighbours } from "../model/neighbours";
import type { Part, Port } from "../model/part";
import type { Parts } from "../model/parts";
import { actualOf, kDesired } from "../model/desired";
import { portsOfJoint } from "../view3d/driving_ports";

const kFinest = 1e9; // parts of a radian or metre that are commanded: 1e-17 is no number to show
const kSlow = 0.1; // of the drive's own maximum speed

export interface Link {
  joint: ChainJoint;
  port: Port; // its desired value
  actual: Port | undefined;
  speed: Port | undefined; // its maximum speed
}

const kMaximumSpeed = /^Maximum .*Speed/;

export class Arm {
  readonly part: Part;

  // `base`: the body that carries the chain, empty for the world. `links`: from the base to the tool.
  // `point`: the point of the tool that moves, in its body's frame, m.
  constructor(readonly tool: string, readonly base: string, readonly links: readonly Link[], readonly point: Vector) {
    this.part = links[0]!.port.part;
  }

  get joints(): ChainJoint[] {
    return this.links.map(({ joint }) => joint);
  }

  // The values that the joints are commanded to.
  commanded(): number[] {
    return this.links.map(({ port }) => port.part.commanded(port));
  }

  // The values that the joints have, as their drives tell them. Of a drive that tells none: as commanded.
  actual(): number[] {
    return this.links.map(({ port, actual }) => (actual ? actual.part.value(actual) : port.part.commanded(port)));
  }

  // The ports that let a joint move at a small share of its drive's maximum speed, as a controller may have
  // left them.
  slowed(): Port[] {
    return this.links.flatMap(({ speed }) => (speed && speed.part.commanded(speed) < kSlow * speed.description.initial ? [speed] : []));
  }

  async hurry(): Promise<void> {
    await writeEach(new Map(this.slowed().map((port) => [port, port.description.initial])));
  }

  // The tool's pose for joint values, in the base's frame.
  at(values: readonly number[]): Pose {
    return forward(this.joints, values);
  }

  solve(target: Pose, start: readonly number[], options: InverseOptions): Solution {
    return solve(this.joints, target, start, options);
  }

  async command(values: readonly number[]): Promise<void> {
    await writeEach(new Map(this.links.map(({ port }, i) => [port, Math.round(values[i]! * kFinest) / kFinest])));
  }
}

async function writeEach(wanted: ReadonlyMap<Port, number>): Promise<void> {
  const runs = neighbours([...wanted.keys()]);
  await Promise.all(runs.map((run) => run[0]!.part.writeValues(run[0]!, run.map((port) => wanted.get(port)!))));
}

// The pose of a body in the world's frame; of the world itself where `body` is -1.
export function bodyPose(sample: WorldSample, body: number): Pose {
  return body < 0 ? kIdentity : poseOf(sample.poses, 7 * body);
}

// The chain that carries `body`. Joints on the way that nothing drives stay where they are in `sample`. Null:
// no driven joint carries it, or joints of two parts do.
export function armOf(description: WorldDescription, sample: WorldSample, parts: Parts, body: string, point: Vector): Arm | null {
  const index = (name: string) => description.bodies.findIndex((one) => one.name === name);
  const links: Link[] = [];
  let rest: Pose = { ...kIdentity, position: point }; // and of the undriven joints behind the last link
  let at = body;
  for (let joint = carrier(description, at); joint; joint = carrier(description, at)) {
    const number = description.joints.indexOf(joint);
    const value = sample.jointPositions[number] ?? 0;
    const [parent, child] = [joint.parent, joint.child].map((name) => bodyPose(sample, name === "" ? -1 : index(name))) as [Pose, Pose];
    const ports = inputsOf(description, parts, joint);
    const port = desiredPort(ports);
    if (port) {
      const moved = jointOf(joint, port, value, compose(inverse(parent), child));
      const speed = ports.find(({ description: { group } }) => kMaximumSpeed.test(group));
      const actual = port.part.port(actualOf(port.description.name));
      links.unshift({ joint: { ...moved, child: compose(moved.child, rest) }, port, actual, speed });
      rest = kIdentity;
    } else {
      rest = compose(compose(inverse(parent), child), rest);
    }
    at = joint.parent;
    if (links.length > kMostJoints || joint.parent === "") break;
  }
  if (links.length === 0 || new Set(links.map(({ port }) => port.part)).size > 1) return null;
  // Undriven joints lie between the base and the first driven one
  links[0] = { ...links[0]!, joint: { ...links[0]!.joint, frame: compose(rest, links[0]!.joint.frame) } };
  return new Arm(body, at, links, point);
}

const kMostJoints = 32;

const carrier = (description: WorldDescription, body: string): JointDescription | undefined =>
  description.joints.find(({ child }) => child === body);

// The inputs that drive a joint; none where nothing does.
function inputsOf(description: WorldDescription, parts: Parts, joint: JointDescription): Port[] {
  const part = parts.find(joint.part);
  if (!part || !(joint.type === "hinge" || joint.type === "slider")) return [];
  const siblings = description.joints.filter((other) => other.part === joint.part && other.type !== "fixed");
  return portsOfJoint(joint, siblings, part.ports.filter(({ side }) => side === "input"));
}

function desiredPort(ports: readonly Port[]): Port | undefined {
  return ports.find(({ description: { group, unit } }) => kDesired.test(group) && (unit === "rad" || unit === "m"));
}

// `between`: the child's pose in the parent's frame, with the joint at `value`. It tells where the child's
// frame is behind the joint.
function jointOf(joint: JointDescription, port: Port, value: number, between: Pose): ChainJoint {
  const [x = 0, y = 0, z = 1] = joint.axis;
  const axis: Vector = [x, y, z];
  const slides = joint.type === "slider";
  const frame = poseOf(joint.pose);
  const limits = port.part.limits(port);
  const limited = joint.upper > joint.lower;
  const bare = {
    name: joint.name, slides, frame, axis,
    lower: Math.max(limits.minimum, limited ? joint.lower : -Infinity),
    upper: Math.min(limits.maximum, limited ? joint.upper : Infinity),
  };
  const moved = compose(frame, motion(bare, value));
  return { ...bare, child: compose(inverse(moved), between) };
}

// The bodies that chains carry, the longest chain first. Where fingers branch off, the hand comes before
// them.
export function tools(description: WorldDescription, parts: Parts): string[] {
  const driven = (joint: JointDescription) => desiredPort(inputsOf(description, parts, joint)) !== undefined;
  const depth = (body: string, left = kMostJoints): number => {
    const joint = carrier(description, body);
    return !joint || left === 0 ? 0 : depth(joint.parent, left - 1) + (driven(joint) ? 1 : 0);
  };
  const branches = (body: string) => description.joints.filter((joint) => joint.parent === body && driven(joint)).length;
  const isFinger = (body: string) => branches(carrier(description, body)?.parent ?? "") > 1 && depth(body) > 1;
  return description.bodies.map(({ name }) => ({ name, rank: depth(name) - (isFinger(name) ? kMostJoints : 0) }))
    .filter(({ name }) => depth(name) > 0)
    .sort((a, b) => b.rank - a.rank)
    .map(({ name }) => name);
}
