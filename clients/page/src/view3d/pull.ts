// A pull as a series of pushes in simulated time, however fast the world runs: a damped spring between the
// hand and the point that it holds. Pure.

export const kPullMs = 40; // wall time from push to push
const kStiffnessPerKg = 60; // N/m for each kg, so that a body of any mass follows alike
const kDampingPerKg = 12; // N·s/m

// Faster than real time, the hand is slower for the world. A spring as stiff as before would swing up between
// two pushes.
export function springPerKg(realTimeFactor: number): { stiffness: number; damping: number } {
  const ahead = Math.max(1, realTimeFactor);
  return { stiffness: kStiffnessPerKg / ahead ** 2, damping: kDampingPerKg / ahead };
}

export class PushTimes {
  private at = -1n; // the tick of the sample that the last push used

  // The duration of a push that uses a sample of `tick`, in simulated ns. Null: the push before has not begun
  // to act; all waiting pushes would act at once.
  next(tick: bigint, tickNs: bigint, realTimeFactor: number): bigint | null {
    if (tick === this.at) return null;
    this.at = tick;
    const ns = BigInt(Math.round(kPullMs * 1e6 * realTimeFactor));
    return ns > tickNs ? ns : tickNs;
  }
}
