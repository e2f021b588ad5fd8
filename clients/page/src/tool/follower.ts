// How far an arm is behind what its joints are commanded to, and whether it comes nearer.
import { inDegrees } from "../ui/numbers";
import type { Arm } from "./arm";

const kAheadS = 0.4; // a joint may be behind so long at the speed that it is commanded, as a ramp takes time,
const kNearest = 0.02; // rad or m: so far in any case,
const kSlowS = 0.3; // unless its Maximum Speed lets it move less in this time,
const kMostTurn = 0.08, kMostWay = 0.02; // rad, m: and so far at most, within a following error
const kStuckS = 0.15; // of simulated time: after it nothing more is commanded to a joint that does not move
const kThere = 0.002; // rad or m
const kOff = 0.01; // rad or m: a joint that rests so far from where it should be is held by something
const kStillS = 1; // of simulated time
const kProgress = 5e-4; // rad or m within that time

export interface Behind {
  far: boolean; // too far to command more
  there: boolean; // all joints are where they were commanded
  held: string; // the joint that stands, and where; empty: none
}

export class Follower {
  private since: { timeS: number; values: number[] } | null = null; // when the arm was last seen to move
  private last: { timeS: number; values: readonly number[] } | null = null; // as commanded last
  private movedAt: { timeS: number; value: number }[] = []; // by joint, when it was seen to move
  private speeds: number[]; // of what is commanded, the greatest of late

  constructor(private readonly arm: Arm) {
    this.speeds = arm.links.map(() => 0);
  }

  look(commanded: readonly number[]): Behind {
    const timeS = Number(this.arm.part.sample?.simTimeNs ?? 0n) / 1e9;
    const actual = this.arm.actual();
    const off = commanded.map((value, i) => Math.abs(value - actual[i]!));
    this.learn(commanded, timeS);
    this.watch(actual, timeS);
    const moved = !this.since || timeS < this.since.timeS || actual.some((value, i) => Math.abs(value - this.since!.values[i]!) > kProgress);
    if (moved) this.since = { timeS, values: actual };
    const stands = timeS - this.since!.timeS > kStillS;
    const worst = off.indexOf(Math.max(...off));
    return {
      far: off.some((way, i) => way > this.allowed(i, timeS)),
      there: off.every((way) => !(way > kThere)) || stands,
      held: stands && off[worst]! > kOff ? this.words(worst, off[worst]!) : "",
    };
  }

  // The speed of what is commanded, which the arm may be behind by its ramp.
  private learn(commanded: readonly number[], timeS: number): void {
    const span = this.last ? timeS - this.last.timeS : 0;
    if (span < 0) this.last = null;
    if (this.last && span <= 0) return;
    if (this.last) this.speeds = this.speeds.map((speed, i) => Math.max(Math.abs(commanded[i]! - this.last!.values[i]!) / span, 0.9 * speed));
    this.last = { timeS, values: [...commanded] };
  }

  // As its input allows it now; of a joint without such an input, no bound.
  private fastest(joint: number): number {
    const { speed } = this.arm.links[joint]!;
    return speed ? Math.max(0, speed.part.commanded(speed)) : Infinity;
  }

  private allowed(joint: number, timeS: number): number {
    const nearest = Math.min(kNearest, kThere / 2 + kSlowS * this.fastest(joint));
    if (timeS - this.movedAt[joint]!.timeS > kStuckS) return nearest;
    const most = this.arm.links[joint]!.joint.slides ? kMostWay : kMostTurn;
    return Math.min(most, nearest + kAheadS * Math.min(this.speeds[joint]!, this.fastest(joint)));
  }

  private watch(actual: readonly number[], timeS: number): void {
    actual.forEach((value, i) => {
      const last = this.movedAt[i];
      if (!last || timeS < last.timeS || Math.abs(value - last.value) > kThere) this.movedAt[i] = { timeS, value };
    });
  }

  private words(joint: number, way: number): string {
    const { joint: { name, slides }, speed } = this.arm.links[joint]!;
    const far = slides ? `${(1000 * way).toFixed(1)} mm` : inDegrees(way, "rad");
    const slow = speed && this.fastest(joint) === 0 ? `its ${speed.description.name} is 0` : "look for what holds it: a contact, a load, or too little current";
    return `${name} stays ${far} from where it is commanded; ${slow}`;
  }
}
