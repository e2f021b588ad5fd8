// A pull as pushes, one after the other in simulated time however fast the world runs: a damped spring between the hand
// and the point that it holds. Pure.

export const kPullMs = 40; // of wall time, from push to push
const kStiffnessPerKg = 60; // N/m for each kg: a pulled body of any mass follows alike
const kDampingPerKg = 12; // N·s/m

// Faster than real time the hand is as slow as ever, and a spring as stiff would swing up between two pushes.
export function springPerKg(realTimeFactor: number): { stiffness: number; damping: number } {
  const ahead = Math.max(1, realTimeFactor);
  return { stiffness: kStiffnessPerKg / ahead ** 2, damping: kDampingPerKg / ahead };
}

export class PushTimes {
  private at = -1n; // tick of the sample that the last push came from

  // How long a push lasts that is made of a sample of `tick`, simulated ns; null: the one before has not begun to act, and
  // all that wait would act at once.
  next(tick: bigint, tickNs: bigint, realTimeFactor: number): bigint | null {
    if (tick === this.at) return null;
    this.at = tick;
    const ns = BigInt(Math.round(kPullMs * 1e6 * realTimeFactor));
    return ns > tickNs ? ns : tickNs;
  }
}
