// The pose of the other arm of a mirrored pair: each body that is drawn, turned further by the difference of
// its joints. Only the joints of that arm are known, so it may be a real one. Pure.
import { Matrix4, Quaternion, Vector3 } from "three";
import type { JointDescription, PortDescription } from "../link/messages";

const kDivergence = "Divergence of ";

// For each joint of the part, the index of the port that tells how far the two joints are apart; -1: there is
// none. Angles belong to the part's hinges, lengths to its sliders, both in their order.
export function divergencePorts(joints: readonly JointDescription[], part: string, ports: readonly Pick<PortDescription, "name" | "unit">[]): number[] {
  const portsOf = (unit: string) => ports.flatMap((port, i) => (port.name.startsWith(kDivergence) && port.unit === unit ? [i] : []));
  const found = joints.map(() => -1);
  for (const [type, unit] of [["hinge", "rad"], ["slider", "m"]] as const) {
    const mine = joints.flatMap((joint, i) => (joint.part === part && joint.type === type ? [i] : []));
    const of = portsOf(unit);
    if (of.length === mine.length) mine.forEach((joint, i) => (found[joint] = of[i]!));
  }
  return found;
}

export interface GhostBody {
  body: number;
  joint: number; // the joint that carries it
  parent: number; // body; -1: the world
}

// The bodies that a joint of the part moves, directly or through other bodies. Each comes after its parent.
export function ghostBodies(joints: readonly JointDescription[], part: string, bodyOf: (name: string) => number): GhostBody[] {
  const all = joints.map((joint, index): GhostBody => ({ body: bodyOf(joint.child), joint: index, parent: bodyOf(joint.parent) }));
  const carrier = new Map(all.map((link) => [link.body, link]));
  const depth = (link: GhostBody): number => {
    let links = 0;
    for (let above = carrier.get(link.parent); above && links < all.length; above = carrier.get(above.parent)) links += 1;
    return links;
  };
  const ghosts = new Set<number>();
  return all.map((link) => ({ link, depth: depth(link) })).sort((a, b) => a.depth - b.depth).flatMap(({ link }) => {
    const moved = ghosts.has(link.parent) || joints[link.joint]!.part === part;
    if (!moved || ghosts.has(link.body)) return [];
    ghosts.add(link.body);
    return [link];
  });
}

// The pose of a ghost's body: the pose of its parent's ghost, then the joint, turned by `apart`, then the
// shown child as it hangs on the shown joint.
export function ghostPose(joint: JointDescription, apart: number, parentGhost: Matrix4, parentShown: Matrix4, childShown: Matrix4): Matrix4 {
  const [x = 0, y = 0, z = 0, qw = 1, qx = 0, qy = 0, qz = 0] = joint.pose;
  const [ax = 0, ay = 0, az = 1] = joint.axis;
  const axis = new Vector3(ax, ay, az);
  const inParent = new Matrix4().compose(new Vector3(x, y, z), new Quaternion(qx, qy, qz, qw), new Vector3(1, 1, 1));
  const moved = joint.type === "slider" ? new Matrix4().makeTranslation(axis.multiplyScalar(apart)) : new Matrix4().makeRotationAxis(axis, apart);
  const shownJoint = parentShown.clone().multiply(inParent);
  return parentGhost.clone().multiply(inParent).multiply(moved).multiply(shownJoint.invert()).multiply(childShown);
}
