// The values of ports over the last minutes, at every tick, in ring buffers. The least and greatest value of
// each block are kept as well, so that a plot of any length is drawn from about as many numbers as it has
// pixels. Lost samples leave a gap, which a window shows as nulls. Pure.

export const kBlock = 8; // a plot of 10 s in some hundred pixels reads a few blocks for each pixel

class Channel {
  readonly values: Float32Array;
  readonly low: Float32Array;
  readonly high: Float32Array;
  constructor(capacity: number) {
    this.values = new Float32Array(capacity).fill(NaN);
    this.low = new Float32Array(capacity / kBlock).fill(NaN);
    this.high = new Float32Array(capacity / kBlock).fill(NaN);
  }
  put(slot: number, value: number): void {
    const block = Math.floor(slot / kBlock);
    this.values[slot] = value;
    if (slot % kBlock === 0 || !(this.low[block]! <= value)) this.low[block] = value;
    if (slot % kBlock === 0 || !(this.high[block]! >= value)) this.high[block] = value;
  }
}

export interface Series {
  times: number[];
  values: (number | null)[][];
}

export class History {
  private readonly times: Float64Array;
  private readonly gaps: Uint32Array; // the number of gaps before a sample
  private readonly channels: Channel[] = [];
  private written = 0; // samples since the start; sample n is in slot n % capacity

  // `capacity` is rounded up to whole blocks.
  constructor(channels: number, capacity: number) {
    const rounded = Math.ceil(capacity / kBlock) * kBlock;
    this.times = new Float64Array(rounded);
    this.gaps = new Uint32Array(rounded);
    for (let i = 0; i < channels; ++i) this.channels.push(new Channel(rounded));
  }

  get capacity(): number {
    return this.times.length;
  }
  get length(): number {
    return Math.min(this.written, this.capacity);
  }
  get lastTime(): number {
    return this.written === 0 ? NaN : this.times[(this.written - 1) % this.capacity]!;
  }
  get firstTime(): number {
    return this.written === 0 ? NaN : this.times[this.first % this.capacity]!;
  }

  get width(): number {
    return this.channels.length;
  }

  clear(): void {
    this.written = 0;
  }

  // Forgets a channel's values: the channel gets another port.
  forget(channel: number): void {
    this.channels[channel] = new Channel(this.capacity);
  }

  // Times must grow; a sample of a time that is there, or before it, is dropped. `afterGap`: samples were
  // lost between the last one and this one.
  add(time: number, value: (channel: number) => number, afterGap = false): void {
    if (time <= this.lastTime) return;
    const slot = this.written % this.capacity;
    this.times[slot] = time;
    this.gaps[slot] = this.written === 0 ? 0 : this.gaps[(this.written - 1) % this.capacity]! + (afterGap ? 1 : 0);
    for (let i = 0; i < this.channels.length; ++i) this.channels[i]!.put(slot, value(i));
    ++this.written;
  }

  // Samples from `from` to `to`, thinned to about `most` points: the least and the greatest value of each
  // group.
  window(from: number, to: number, most: number, channels: readonly number[]): Series {
    const begin = this.lowerBound(from);
    const end = Math.min(this.written, this.lowerBound(to) + 1);
    const stride = Math.ceil((end - begin) / Math.max(1, most));
    if (stride <= 2) return this.plain(begin, end, channels);
    // Whole blocks if the groups are large enough, else single samples.
    const group = stride >= kBlock ? Math.ceil((2 * stride) / kBlock) * kBlock : 2 * stride;
    return this.thinned(begin - (begin % group), end, group, channels);
  }

  // Every sample, for export.
  all(channels: readonly number[]): Series {
    return this.plain(this.first, this.written, channels, false);
  }

  // A copy with room for more channels. Of the new channels nothing is known so far.
  widened(channels: number): History {
    const wide = new History(channels, this.capacity);
    for (let n = this.first; n < this.written; ++n) {
      const slot = n % this.capacity;
      wide.add(this.times[slot]!, (channel) => this.channels[channel]?.values[slot] ?? NaN, n > this.first && this.gapWithin(n - 1, n));
    }
    return wide;
  }

  private get first(): number {
    return this.written - this.length;
  }

  // The first sample at or after `time`.
  private lowerBound(time: number): number {
    let low = this.first;
    let high = this.written;
    while (low < high) {
      const middle = Math.floor((low + high) / 2);
      if (this.times[middle % this.capacity]! < time) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  // True if samples were lost between two samples.
  private gapWithin(a: number, b: number): boolean {
    return this.gaps[a % this.capacity] !== this.gaps[b % this.capacity];
  }

  private plain(begin: number, end: number, channels: readonly number[], showGaps = true): Series {
    const series: Series = { times: [], values: channels.map(() => []) };
    for (let n = begin; n < end; ++n) {
      if (showGaps && n > begin && this.gapWithin(n - 1, n)) this.pushGap(series, n);
      const slot = n % this.capacity;
      series.times.push(this.times[slot]!);
      channels.forEach((channel, i) => series.values[i]!.push(known(this.channels[channel]!.values[slot])));
    }
    return series;
  }

  private thinned(begin: number, end: number, group: number, channels: readonly number[]): Series {
    const series: Series = { times: [], values: channels.map(() => []) };
    for (let n = begin; n < end; n += group) {
      const from = Math.max(n, this.first);
      const to = Math.min(n + group, end);
      if (from >= to) continue;
      if (series.times.length > 0 && this.gapWithin(from - 1, from)) this.pushGap(series, from);
      const cut = this.afterWidestGap(from, to);
      this.pushGroup(series, from, cut, channels);
      if (cut === to) continue;
      this.pushGap(series, cut);
      this.pushGroup(series, cut, to, channels);
    }
    return series;
  }

  private pushGroup(series: Series, from: number, to: number, channels: readonly number[]): void {
    series.times.push(this.times[from % this.capacity]!, this.times[(to - 1) % this.capacity]!);
    channels.forEach((channel, i) => this.pushRange(series.values[i]!, channel, from, to));
  }

  // Adds a null in the middle between sample n and the one before.
  private pushGap(series: Series, n: number): void {
    series.times.push((this.times[(n - 1) % this.capacity]! + this.times[n % this.capacity]!) / 2);
    for (const values of series.values) values.push(null);
  }

  // Only the widest gap within a group is shown. Returns the sample behind it, or `to` if there is no gap.
  private afterWidestGap(from: number, to: number): number {
    if (!this.gapWithin(from, to - 1)) return to;
    let found = to;
    let widest = 0;
    for (let n = from + 1; n < to; ++n) {
      const width = this.times[n % this.capacity]! - this.times[(n - 1) % this.capacity]!;
      if (!this.gapWithin(n - 1, n) || width <= widest) continue;
      widest = width;
      found = n;
    }
    return found;
  }

  // Adds the least and the greatest value; nulls where the port was not recorded.
  private pushRange(values: (number | null)[], channel: number, from: number, to: number): void {
    const { values: all, low, high } = this.channels[channel]!;
    let least = Infinity;
    let greatest = -Infinity;
    for (let n = from; n < to; ) {
      const slot = n % this.capacity;
      const whole = slot % kBlock === 0 && n + kBlock <= to;
      const block = slot / kBlock;
      const a = whole ? low[block]! : all[slot]!;
      const b = whole ? high[block]! : all[slot]!;
      if (a < least) least = a; // false for NaN, which means that the port was not recorded then
      if (b > greatest) greatest = b;
      n += whole ? kBlock : 1;
    }
    const known = least <= greatest;
    values.push(known ? least : null, known ? greatest : null);
  }
}

// A value that was not recorded becomes null.
function known(value: number | undefined): number | null {
  return value === undefined || Number.isNaN(value) ? null : value;
}
