// The poses of all bodies over the last moments, and between them: positions linearly, orientations along the
// shorter way. A pose is x y z qw qx qy qz, as in the protocol. Pure.

const kNumbers = 7;
const kKept = 16;

interface Sample {
  time: number; // simulated ms
  poses: readonly number[];
}

export class PoseBuffer {
  private samples: Sample[] = [];

  clear(): void {
    this.samples = [];
  }

  add(time: number, poses: readonly number[]): void {
    const last = this.samples.at(-1);
    if (last && (time < last.time || poses.length !== last.poses.length)) this.clear();
    if (last && time === last.time) this.samples.pop();
    this.samples.push({ time, poses });
    if (this.samples.length > kKept) this.samples.shift();
  }

  // Writes the poses at `time` to `out`, or the nearest ones that are known. Returns false if none are known.
  at(time: number, out: Float64Array): boolean {
    const after = this.samples.findIndex((sample) => sample.time >= time);
    const b = this.samples.at(after);
    if (!b) return false;
    const a = after > 0 ? this.samples[after - 1] : undefined;
    if (!a || time >= b.time) out.set(b.poses.slice(0, out.length));
    else between(a.poses, b.poses, (time - a.time) / (b.time - a.time), out);
    return true;
  }
}

export function between(a: readonly number[], b: readonly number[], share: number, out: Float64Array): void {
  const count = Math.min(out.length, a.length, b.length);
  for (let at = 0; at + kNumbers <= count; at += kNumbers) {
    for (let i = at; i < at + 3; ++i) out[i] = a[i]! + share * (b[i]! - a[i]!);
    let dot = 0;
    for (let i = at + 3; i < at + 7; ++i) dot += a[i]! * b[i]!;
    const sign = dot < 0 ? -1 : 1; // q and -q are the same orientation
    let norm = 0;
    for (let i = at + 3; i < at + 7; ++i) {
      out[i] = (1 - share) * a[i]! + share * sign * b[i]!;
      norm += out[i]! * out[i]!;
    }
    const scale = 1 / Math.sqrt(norm || 1);
    for (let i = at + 3; i < at + 7; ++i) out[i]! *= scale;
  }
}
