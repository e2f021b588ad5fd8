// A recording that visumd shows in place of a live world: its length, the position in it, and the result of
// comparing it with the bits that this program computes; and a second recording beside it, if there is one.
// The page steers it through a part of its own (server/gateway/playback.h).
import type { Link } from "../link/link";
import { BesideBodies, type BesideReport } from "./beside";
import type { Part } from "./part";
import type { Parts } from "./parts";
import { poll } from "./poll";
import { Signal } from "../common/signal";

export interface PortDifference {
  part: string;
  port: string;
  recorded: string; // numbers with all their digits
  replayed: string;
}
export interface Report {
  file: string;
  ticks: number;
  tick_ns: number;
  position: number; // ticks since its beginning
  compared: number; // the number of ticks with the same bits
  equal: boolean;
  damage: string;
  difference?: { position: number; tick: number; era: number; what: string; other_build: string; ports: PortDifference[] };
  beside?: BesideReport; // the second recording
}

const kPeriodMs = 500;
const kFrameNs = 33e6;
const kPlottedTicks = 10_000; // the server gives no more at once
const kAheadTicks = 5000; // of the second recording, while the first one plays

export class Recording {
  readonly report = new Signal<Report | null>(null); // null: the world is live
  readonly position = new Signal<number>(0);
  readonly bodies = new BesideBodies();
  playing = false; // by the server's last status
  private part = "";
  private wanted: number | null = null; // the target of the latest jump that is not made yet
  private jumping: Promise<void> | null = null;
  private looking = false; // for B's bodies
  private lookAgain = false;
  private jumps = 0;
  private refills = 0;
  private refilledTo = -1; // the position up to which the plots were filled
  private filled = new Map<Part, number>(); // up to which position a part has B's values

  constructor(private readonly link: Link, private readonly parts: Parts) {
    link.told.on((body) => {
      if (body.case === "partSample" && body.value.part === this.part) this.moved(body.value.sensorOutputs[0]!);
    });
    parts.plotsChanged.on(() => void this.refill());
    poll(() => this.refresh(), kPeriodMs);
  }

  // Call it after each hello. `part` steers the recording; null means that the world is live.
  async begin(part: string | null): Promise<void> {
    this.part = part ?? "";
    this.link.recorded.value = part !== null;
    if (part === null) return void (this.report.value = null);
    const everyNTicks = Math.max(1, Math.round(kFrameNs / Number(this.link.welcome?.tickNs ?? 1_000_000n)));
    await this.link.request({ case: "subscribe", value: { part, everyNTicks } }, "ok");
    await this.refresh();
  }

  // Resolves when the last of the jumps is made that were asked for meanwhile.
  seek(position: number): Promise<void> {
    this.wanted = position;
    this.jumping ??= this.jump().finally(() => (this.jumping = null));
    return this.jumping;
  }

  // Fills the plots with what was recorded before this position, A's and B's values at once. An answer for a
  // position in the past is dropped, and the next refresh() asks again.
  private async refill(): Promise<void> {
    this.refilledTo = -1;
    if (this.report.value === null || this.playing) return;
    const [to, beside] = [this.position.value, this.hasBeside];
    const refills = ++this.refills;
    for (const [number, part] of this.parts.list.value.entries()) {
      if (!part.isPlotted) continue;
      const stretch = `ports/${number}/${to}/${kPlottedTicks}`;
      const [rows, ofB] = await Promise.all([this.rows(stretch), beside ? this.rows(`beside/${stretch}`) : new Float64Array()]);
      if (this.refills !== refills || this.position.value !== to || this.playing) return;
      if (rows) part.refill(rows);
      if (beside && ofB) this.fillBeside(part, ofB, to, true);
    }
    this.refilledTo = to;
  }

  private get hasBeside(): boolean {
    return this.report.value?.beside !== undefined;
  }

  // Null where the recording has none, as of a part that came later, or where the server is gone.
  private async rows(path: string): Promise<Float64Array | null> {
    try {
      const answer = await fetch(`/recording/${path}`, { headers: this.link.headers });
      return answer.ok ? new Float64Array(await answer.arrayBuffer()) : null;
    } catch {
      return null;
    }
  }

  // `rows`: B's values up to `to`. `anew`: in place of those that the part has.
  private fillBeside(part: Part, rows: Float64Array, to: number, anew: boolean): void {
    part.refillBeside(rows, anew);
    this.filled.set(part, to);
  }

  // While A plays, its values come tick by tick. Those of B are fetched ahead of it.
  private async fillAhead(): Promise<void> {
    const [position, jumps, ticks] = [this.position.value, this.jumps, this.report.value!.ticks];
    for (const [number, part] of this.parts.list.value.entries()) {
      if (!part.isPlotted) continue;
      const filled = part.besides() ? (this.filled.get(part) ?? -1) : -1;
      if (filled >= Math.min(ticks, position + kAheadTicks / 2)) continue;
      const to = Math.min(ticks, position + kAheadTicks);
      const anew = filled < position; // nothing, or not enough to go on from
      const rows = await this.rows(`beside/ports/${number}/${to}/${anew ? kPlottedTicks : to - filled}`);
      if (rows && this.jumps === jumps && this.playing) this.fillBeside(part, rows, to, anew);
    }
  }

  // One question at a time; a further one where the world moved on meanwhile.
  private async look(): Promise<void> {
    if (!this.hasBeside) return;
    this.lookAgain = this.looking;
    if (this.looking) return;
    this.looking = true;
    const board = await this.link.request({ case: "readBlackboard", value: { part: this.part, name: "Beside" } }, "blackboard").catch(() => null);
    this.looking = false;
    if (!board) return;
    this.bodies.take(board.data);
    if (this.lookAgain) await this.look();
  }

  get atEnd(): boolean {
    return this.report.value !== null && this.position.value >= this.report.value.ticks;
  }

  private async jump(): Promise<void> {
    while (this.wanted !== null) {
      const position = this.wanted;
      this.wanted = null;
      this.jumps += 1;
      this.filled.clear();
      const value = { case: "integer", value: BigInt(position) } as const;
      await this.link.request({ case: "setParameter", value: { part: this.part, name: "Position", value: { value } } }, "ok");
      this.moved(position);
      void this.refill();
    }
  }

  private moved(position: number): void {
    this.show(position);
    void this.look();
  }

  private show(position: number): void {
    if (this.wanted === null) this.position.value = position;
  }

  async refresh(): Promise<void> {
    if (this.part === "" || !this.link.welcome) return;
    const board = await this.link.request({ case: "readBlackboard", value: { part: this.part, name: "Report" } }, "blackboard").catch(() => null);
    if (!board) return;
    const report = JSON.parse(new TextDecoder().decode(board.data)) as Report;
    this.report.value = report;
    this.parts.beside.value = report.beside?.file ?? "";
    if (!this.jumping) this.position.value = report.position;
    if (this.playing && this.hasBeside) await this.fillAhead();
    if (!this.playing && this.refilledTo !== this.position.value) await this.refill();
    if (this.hasBeside && this.bodies.position !== this.position.value) await this.look();
  }
}
