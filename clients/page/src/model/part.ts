// One part: its ports with their live values, the holder of its lease, and what the page writes and records.
import type { Link } from "../link/link";
import { ErrorCode, LostError, RequestError, type BlackboardData, type PartDescription, type PartSample, type PortDescription } from "../link/messages";
import { History } from "./history";
import { neighbours } from "./neighbours";
import { softLimits, type Limits } from "./soft_limits";
import { Emitter, Signal } from "../common/signal";

export type Side = "input" | "output";
export interface Port {
  part: Part;
  side: Side;
  index: number; // in its vector
  description: PortDescription;
}

const kHistorySamples = 300_000; // five minutes at a tick of 1 ms
const kBesideSamples = 20_000; // what is asked for at once, and some
const kRecordedMost = 48; // ports of one part
const kIdlePeriodMs = 33;
const kNsPerS = 1e9;

// The last value that this page wrote to an input, until it is in force.
interface Written {
  value: number;
  after: number; // s; a sample of a later time has the value. Infinity: not answered yet; -Infinity: refused
  before: Written | undefined;
}

export class Part {
  readonly ports: Port[] = [];
  readonly holder = new Signal<string>("");
  readonly leased = new Signal<boolean>(false); // by this page
  readonly sampled = new Emitter<PartSample>();
  sample: PartSample | null = null;
  conflated = 0;
  readonly held = new Map<number, number>(); // inputs that the page holds at a value
  readonly gaveUp = new Emitter<string>(); // a text: the ports that the page had to stop holding, and why
  private readonly soft: Map<string, Limits>;
  private keeping = false; // a write of held values is under way
  private history: History | null = null;
  private beside: History | null = null; // the same ports in a second recording, with the same channels
  private readonly written = new Map<number, Written>(); // by input
  private recorded: Port[] = []; // by channel
  private uses: number[] = []; // by channel: the number of plots that want it
  private readonly periods = new Map<symbol, number>(); // ms of wall time from sample to sample, by recording
  private everyTicks = 0;
  private reconnected = false; // since the last sample
  private era = -1n;

  constructor(private readonly link: Link, readonly description: PartDescription) {
    this.soft = softLimits(description);
    for (const [side, list] of [["input", description.controllerInputs], ["output", description.sensorOutputs]] as const)
      list.forEach((port, index) => this.ports.push({ part: this, side, index, description: port }));
  }

  get name(): string {
    return this.description.name;
  }

  port(name: string): Port | undefined {
    return this.ports.find((port) => port.description.name === name);
  }

  value(port: Port): number {
    const vector = port.side === "input" ? this.sample?.controllerInputs : this.sample?.sensorOutputs;
    return vector?.[port.index] ?? NaN;
  }

  // The range of values that do not lead into a fault, as far as the part tells it. A port takes more.
  limits(port: Port): Limits {
    return (port.side === "input" ? this.soft.get(port.description.name) : undefined) ?? port.description;
  }

  // The value from which relative controls count. While the world is paused, or between two samples, the last
  // written value is not in force yet.
  commanded(port: Port): number {
    return (port.side === "input" ? this.written.get(port.index)?.value : undefined) ?? this.value(port);
  }

  async acquire(take = false): Promise<void> {
    await this.link.request({ case: "acquireLease", value: { part: this.name, deadlineNs: 0n, take } }, "lease");
    this.leased.value = true;
    this.holder.value = this.link.name;
  }

  async release(): Promise<void> {
    const held = [...this.held];
    this.held.clear(); // at once: after the release nothing may be written
    try {
      await this.link.request({ case: "releaseLease", value: { part: this.name } }, "ok");
    } catch (error) {
      for (const [index, value] of held) this.held.set(index, value);
      // Else it was lost before
      if (!(error instanceof RequestError && error.code === ErrorCode.ERROR_NO_LEASE)) throw error;
    }
    this.leaseLost();
  }

  leaseLost(): void {
    this.leased.value = false;
    this.holder.value = "";
    this.written.clear();
    this.giveUp([...this.held.keys()], `the lease of '${this.name}' is lost`);
  }

  async write(port: Port, value: number): Promise<void> {
    await this.writeValues(port, [value]);
  }

  // Writes several inputs at once, all or nothing, so that a part's demands on several inputs together can be
  // met. A held port takes no other value.
  async writeValues(first: Port, values: number[]): Promise<void> {
    if (first.side !== "input") throw new Error(`'${first.description.name}' is a sensor output`);
    values.forEach((value, i) => {
      const held = this.held.get(first.index + i);
      if (held !== undefined && held !== value) throw new Error(`'${this.inputName(first.index + i)}' is held at ${held}`);
    });
    await this.send(first.index, values);
  }

  readBlackboard(name: string): Promise<BlackboardData> {
    return this.link.request({ case: "readBlackboard", value: { part: this.name, name } }, "blackboard");
  }

  // Call it when the session that subscribed is gone.
  forgetSubscription(): void {
    this.everyTicks = 0;
    this.reconnected = true;
  }

  take(sample: PartSample): void {
    this.sample = sample;
    const again = this.reconnected;
    const lost = again || Number(sample.conflated) > this.conflated;
    this.reconnected = false;
    this.conflated = Number(sample.conflated);
    const time = Number(sample.simTimeNs) / kNsPerS;
    for (const [index, { after }] of this.written) if (time > after) this.written.delete(index);
    if (sample.era !== this.era) {
      this.era = sample.era;
      this.written.clear();
      if (time !== this.history?.lastTime) this.history?.clear(); // else refill() has filled it up to here
    } else if (again && this.history && time < this.history.lastTime) this.history.clear(); // another server
    const recorded = this.recorded;
    this.history?.add(time, (channel) => {
      const port = recorded[channel]!;
      return (port.side === "input" ? sample.controllerInputs : sample.sensorOutputs)[port.index]!;
    }, lost);
    this.keepHeld(sample);
    this.sampled.emit(sample);
  }

  // Subscribes as often as the most eager recording needs it, and as an eye can follow numbers.
  async subscribe(tickNs: number, realTimeFactor: number): Promise<void> {
    const ticksPerMs = (1e6 / tickNs) * Math.max(realTimeFactor, 0.01);
    const periodMs = Math.min(kIdlePeriodMs, ...this.periods.values());
    // Faster than real time, nobody takes every tick
    const every = Math.max(1, Math.floor(periodMs === 0 ? realTimeFactor : periodMs * ticksPerMs));
    const close = every < 1.5 * this.everyTicks && every > 0.6 * this.everyTicks;
    if (close) return;
    this.everyTicks = every;
    await this.link.request({ case: "subscribe", value: { part: this.name, everyNTicks: every } }, "ok");
  }

  // Begins to record for a plot: every tick, or a sample each `periodMs` of wall time. Call the returned
  // function when the plot does not need it any more. Without ports, the present recording stays meanwhile.
  // Throws, and changes nothing, if they are too many ports.
  record(ports: readonly Port[], periodMs = 0): () => void {
    const wanted = new Set([...this.recorded.filter((_, channel) => this.uses[channel]! > 0), ...ports]);
    if (wanted.size > kRecordedMost) throw new Error(`at most ${kRecordedMost} ports of '${this.name}' are recorded at a time`);
    const key = Symbol();
    this.periods.set(key, ports.length === 0 ? kIdlePeriodMs : periodMs);
    const [known, fresh] = [ports.filter((port) => this.channel(port) >= 0), ports.filter((port) => this.channel(port) < 0)];
    for (const port of [...known, ...fresh]) this.uses[this.channelFor(port)]! += 1;
    return () => {
      for (const port of ports) this.uses[this.channel(port)]! -= 1;
      this.periods.delete(key);
      if (this.periods.size > 0) return;
      this.history = this.beside = null;
      this.recorded = [];
      this.uses = [];
    };
  }

  get isPlotted(): boolean {
    return this.history !== null;
  }

  // Fills the history from a recording: rows of time (s), controller inputs, sensor outputs.
  refill(rows: Float64Array): void {
    this.history?.clear();
    this.fill(this.history, rows);
  }
  // The same for the second recording. Unless `anew`, the rows come after those that are there.
  refillBeside(rows: Float64Array, anew: boolean): void {
    if (!this.history) return;
    this.beside ??= new History(this.history.width, kBesideSamples);
    if (anew || rows[0]! <= this.beside.lastTime) this.beside.clear(); // time began anew there, too
    this.fill(this.beside, rows);
  }

  private fill(history: History | null, rows: Float64Array): void {
    const width = 1 + this.ports.length;
    const inputs = this.description.controllerInputs.length;
    for (let at = 0; at + width <= rows.length; at += width)
      history?.add(rows[at]!, (channel) => {
        const port = this.recorded[channel]!;
        return rows[at + 1 + (port.side === "input" ? 0 : inputs) + port.index]!;
      });
  }

  // The channel of a port in recordings(); -1: it is not recorded.
  channel(port: Port): number {
    return this.recorded.indexOf(port);
  }
  recordings(): History | null {
    return this.history;
  }
  // The same ports in the second recording; null: nothing is known of them.
  besides(): History | null {
    return this.beside;
  }

  // Returns the port's own channel, or a new one. If there are enough channels, it takes one that no plot
  // wants any more.
  private channelFor(port: Port): number {
    const own = this.channel(port);
    if (own >= 0) return own;
    const free = this.recorded.length < kRecordedMost ? this.recorded.length : this.uses.indexOf(0);
    this.recorded[free] = port;
    this.beside = null; // it is filled anew
    this.uses[free] = 0;
    if (this.history && free < this.history.width) this.history.forget(free);
    else this.history = this.history?.widened(free + 1) ?? new History(free + 1, kHistorySamples);
    return free;
  }

  private async send(firstPort: number, values: number[]): Promise<void> {
    const written = values.map((value, i) => ({ index: firstPort + i, value, after: Infinity, before: this.written.get(firstPort + i) }));
    for (const entry of written) this.written.set(entry.index, entry);
    try {
      await this.link.request({ case: "write", value: { part: this.name, firstPort, values, sequence: 0n } }, "ok");
      for (const entry of written) {
        entry.after = Number(this.sample?.simTimeNs ?? -1n) / kNsPerS;
        entry.before = undefined;
      }
    } catch (error) {
      for (const entry of written) {
        entry.after = -Infinity;
        this.dropRefused(entry.index);
      }
      throw error;
    }
  }

  // Drops refused writes, so that the value written before them counts again.
  private dropRefused(index: number): void {
    let entry = this.written.get(index);
    while (entry?.after === -Infinity) entry = entry.before;
    if (entry) this.written.set(index, entry);
    else this.written.delete(index);
  }

  private keepHeld(sample: PartSample): void {
    if (this.held.size === 0 || !this.leased.value || this.keeping) return;
    const held = this.ports.filter(({ side, index }) => side === "input" && this.held.has(index));
    const moved = neighbours(held).filter((run) => run.some(({ index }) => sample.controllerInputs[index] !== this.held.get(index)));
    if (moved.length === 0) return;
    this.keeping = true;
    void Promise.all(moved.map((run) => this.keep(run))).finally(() => (this.keeping = false));
  }

  private async keep(run: Port[]): Promise<void> {
    const indices = run.map(({ index }) => index);
    try {
      await this.send(indices[0]!, indices.map((index) => this.held.get(index)!));
    } catch (error) {
      // The next sample tries again
      if (error instanceof LostError || (error instanceof RequestError && error.code === ErrorCode.ERROR_BUSY)) return;
      this.giveUp(indices, (error as Error).message);
    }
  }

  private giveUp(indices: number[], reason: string): void {
    const names = indices.filter((index) => this.held.delete(index)).map((index) => this.inputName(index));
    if (names.length > 0) this.gaveUp.emit(`No longer held: ${names.join(", ")} (${reason})`);
  }

  private inputName(index: number): string {
    return this.description.controllerInputs[index]!.name;
  }
}
