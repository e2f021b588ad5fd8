// Brings the tool to a goal along a straight line, at a bounded speed. It commands joints every few
// milliseconds, from the joint values that were commanded last, so that the arm stays near them.
import { type Pose, add, aboutAxis, length, multiply, rotationBetween, scale, subtract } from "../kinematics/pose";
import { Emitter } from "../common/signal";
import type { Arm } from "./arm";

const kPeriodMs = 40;
const kTolerance = 2e-5; // m and rad: below what a drive resolves
const kIterations = 40;
const kFarthestTurn = 0.35; // rad or m: a joint that would jump so far in one step is at a singularity

export interface Speeds {
  metresPerS: number;
  radiansPerS: number;
}

export class Mover {
  readonly stopped = new Emitter<string>(); // why it has ended before its goal
  speeds: Speeds = { metresPerS: 0.15, radiansPerS: 0.8 };
  private arm: Arm | null = null;
  private goal: Pose | null = null;
  private now: { pose: Pose; values: number[] } | null = null; // as commanded last
  private timer = 0;
  private asking = false;

  use(arm: Arm | null): void {
    this.halt();
    this.arm = arm;
  }

  // Where the tool is commanded to be, in the base's frame.
  commanded(): Pose | null {
    return this.now?.pose ?? (this.arm ? this.arm.at(this.arm.commanded()) : null);
  }

  // Where it goes to; where it is commanded to be, if it does not move. In the base's frame.
  target(): Pose | null {
    return this.goal ?? this.commanded();
  }

  // `follow`: as near as can be, where the goal is out of reach, as under a hand that drags.
  go(goal: Pose, follow = false): void {
    if (!this.arm) return;
    this.goal = goal;
    this.now ??= { pose: this.arm.at(this.arm.commanded()), values: this.arm.commanded() };
    if (this.timer === 0) this.timer = window.setInterval(() => void this.step(follow), kPeriodMs);
  }

  halt(): void {
    clearInterval(this.timer);
    this.timer = 0;
    this.goal = this.now = null;
  }

  private async step(follow: boolean): Promise<void> {
    const { arm, goal, now } = this;
    if (this.asking || !arm || !goal || !now) return;
    if (!arm.part.leased.value) return this.give(`control of ${arm.part.name} is lost`);
    const pose = towards(now.pose, goal, this.speeds, kPeriodMs / 1000);
    const found = arm.solve(pose, now.values, { starts: 1, tolerance: kTolerance, iterations: kIterations });
    const jump = Math.max(...found.values.map((value, i) => Math.abs(value - now.values[i]!)));
    if (!follow && !found.reached) return this.give("that is out of reach, or a joint is at its limit");
    if (jump > kFarthestTurn) return follow ? undefined : this.give("a joint would have to turn too fast there (a singular pose)");
    this.now = { pose: found.reached ? pose : arm.at(found.values), values: found.values };
    this.asking = true;
    try {
      await arm.command(found.values);
    } catch (error) {
      return this.give((error as Error).message);
    } finally {
      this.asking = false;
    }
    if (pose === this.goal && !follow) this.halt();
  }

  private give(why: string): void {
    this.halt();
    this.stopped.emit(why);
  }
}

// A pose on the straight line to the goal, as far as the speeds allow in `seconds`; at its end the goal
// itself. Pure.
export function towards(from: Pose, goal: Pose, { metresPerS, radiansPerS }: Speeds, seconds: number): Pose {
  const way = subtract(goal.position, from.position);
  const turn = rotationBetween(from.orientation, goal.orientation);
  const needs = Math.max(length(way) / metresPerS, length(turn) / radiansPerS);
  if (!(needs > seconds)) return goal;
  const share = seconds / needs;
  const angle = length(turn);
  const part = angle > 0 ? aboutAxis(scale(turn, 1 / angle), share * angle) : ([1, 0, 0, 0] as const);
  return { position: add(from.position, scale(way, share)), orientation: multiply([...part], from.orientation) };
}
