// What ports were over the last minutes, at full tick rate: rings of numbers, with the least and greatest of each block
// beside them, so that a plot of any length is drawn from about as many numbers as it has pixels. Pure.

export const kBlock = 64;

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
  private readonly channels: Channel[] = [];
  private written = 0; // samples since the start; sample n stands in slot n % capacity

  // `capacity` is rounded up to whole blocks.
  constructor(channels: number, capacity: number) {
    const rounded = Math.ceil(capacity / kBlock) * kBlock;
    this.times = new Float64Array(rounded);
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

  clear(): void {
    this.written = 0;
  }

  // Times grow; a time that does not begins anew (a reset).
  add(time: number, value: (channel: number) => number): void {
    if (time < this.lastTime) this.clear();
    if (time === this.lastTime) return;
    const slot = this.written % this.capacity;
    this.times[slot] = time;
    for (let i = 0; i < this.channels.length; ++i) this.channels[i]!.put(slot, value(i));
    ++this.written;
  }

  // Samples from `from` to `to`, thinned to about `most` points: of each group its least and greatest value.
  window(from: number, to: number, most: number, channels: readonly number[]): Series {
    const begin = this.lowerBound(from);
    const end = Math.min(this.written, this.lowerBound(to) + 1);
    const stride = Math.ceil((end - begin) / Math.max(1, most));
    if (stride <= 2) return this.plain(begin, end, channels);
    // Whole blocks where the groups are large enough; single samples else.
    const group = stride >= kBlock ? Math.ceil((2 * stride) / kBlock) * kBlock : 2 * stride;
    return this.thinned(begin - (begin % group), end, group, channels);
  }

  // Every sample, for export.
  all(channels: readonly number[]): Series {
    return this.plain(this.first, this.written, channels);
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

  private plain(begin: number, end: number, channels: readonly number[]): Series {
    const series: Series = { times: [], values: channels.map(() => []) };
    for (let n = begin; n < end; ++n) {
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
      series.times.push(this.times[from % this.capacity]!, this.times[(to - 1) % this.capacity]!);
      channels.forEach((channel, i) => series.values[i]!.push(...this.range(channel, from, to)));
    }
    return series;
  }

  private range(channel: number, from: number, to: number): [number | null, number | null] {
    const { values, low, high } = this.channels[channel]!;
    let least = Infinity;
    let greatest = -Infinity;
    for (let n = from; n < to; ) {
      const slot = n % this.capacity;
      const whole = slot % kBlock === 0 && n + kBlock <= to;
      const block = slot / kBlock;
      const a = whole ? low[block]! : values[slot]!;
      const b = whole ? high[block]! : values[slot]!;
      if (a < least) least = a; // not of NaN, which stands for a time when the port was not recorded
      if (b > greatest) greatest = b;
      n += whole ? kBlock : 1;
    }
    return least <= greatest ? [least, greatest] : [null, null];
  }
}

// What was not recorded is nothing, and no number.
function known(value: number | undefined): number | null {
  return value === undefined || Number.isNaN(value) ? null : value;
}
