// Brings the tool to a goal along a straight line, at a bounded speed. It commands joints every few
// milliseconds, from the joint values that were commanded last, so that the arm stays near them. Where the
// arm falls behind, it waits: a slow arm stays on its line, and what is in the way is not pressed ever
// harder.
import { hindrance } from "../bar/part_state";
import { type Pose, add, aboutAxis, length, multiply, rotationBetween, scale, subtract } from "../kinematics/pose";
import { Emitter } from "../common/signal";
import type { Arm } from "./arm";
import { Follower } from "./follower";

const kPeriodMs = 40;
const kTolerance = 2e-5; // m and rad: below what a drive resolves
const kIterations = 40;
const kElsewhere = 0.05; // rad or m
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
  private follower: Follower | null = null;
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
    this.now ??= this.start(this.arm);
    this.follower ??= new Follower(this.arm);
    if (this.timer === 0) this.timer = window.setInterval(() => void this.step(follow), kPeriodMs);
  }

  // Begins at what was commanded, unless the arm is elsewhere, as after a fault.
  private start(arm: Arm): { pose: Pose; values: number[] } {
    const [commanded, actual] = [arm.commanded(), arm.actual()];
    const isElsewhere = commanded.some((value, i) => Math.abs(value - actual[i]!) > kElsewhere);
    const values = isElsewhere ? actual : commanded;
    return { pose: arm.at(values), values };
  }

  halt(): void {
    clearInterval(this.timer);
    this.timer = 0;
    this.goal = this.now = this.follower = null;
  }

  private async step(follow: boolean): Promise<void> {
    const { arm, goal, now, follower } = this;
    if (this.asking || !arm || !goal || !now || !follower) return;
    if (!arm.part.leased.value) return this.give(`control of ${arm.part.name} is lost`);
    const hindered = hindrance(arm.part);
    if (hindered !== "") return this.letGo(hindered);
    const behind = follower.look(now.values);
    if (behind.held !== "" && !follow) return this.letGo(behind.held);
    if (behind.far) return;
    if (now.pose === goal) return behind.there && !follow ? this.halt() : undefined;
    const pose = towards(now.pose, goal, this.speeds, kPeriodMs / 1000);
    const found = arm.solve(pose, now.values, { starts: 1, tolerance: kTolerance, iterations: kIterations });
    const jump = Math.max(...found.values.map((value, i) => Math.abs(value - now.values[i]!)));
    if (!follow && !found.reached) return this.give("that is out of reach, or a joint is at its limit");
    if (jump > kFarthestTurn) return follow ? undefined : this.give("a joint would have to turn too fast there (a singular pose)");
    this.now = { pose: found.reached ? pose : arm.at(found.values), values: found.values };
    await this.command(arm, found.values);
  }

  // Nothing is pressed any longer once the arm is told to be where it is.
  private async letGo(why: string): Promise<void> {
    const { arm } = this;
    this.give(why);
    if (arm) await this.command(arm, arm.actual());
  }

  private async command(arm: Arm, values: readonly number[]): Promise<void> {
    this.asking = true;
    try {
      await arm.command(values);
    } catch (error) {
      this.give((error as Error).message);
    } finally {
      this.asking = false;
    }
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
