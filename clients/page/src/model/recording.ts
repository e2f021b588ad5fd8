// A recording that visumd shows in place of a live world: its length, the position in it, and the result of
// comparing it with the bits that this program computes. The page steers it through a part of its own
// (server/gateway/playback.h).
import type { Link } from "../link/link";
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
}

const kPeriodMs = 500;
const kFrameNs = 33e6;
const kPlottedTicks = 10_000; // the server gives no more at once

export class Recording {
  readonly report = new Signal<Report | null>(null); // null: the world is live
  readonly position = new Signal<number>(0);
  playing = false; // by the server's last status
  private part = "";
  private wanted: number | null = null; // the target of the latest jump that is not made yet
  private jumping: Promise<void> | null = null;

  constructor(private readonly link: Link, private readonly parts: Parts) {
    link.told.on((body) => {
      if (body.case === "partSample" && body.value.part === this.part) this.show(body.value.sensorOutputs[0]!);
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

  // Fills the plots with what was recorded before this position. It does nothing while the position moves on:
  // the answer would be for a position in the past.
  async refill(): Promise<void> {
    if (this.report.value === null || this.playing) return;
    const to = this.position.value;
    for (const [number, part] of this.parts.list.value.entries()) {
      if (!part.isPlotted) continue;
      const answer = await fetch(`/recording/ports/${number}/${to}/${kPlottedTicks}`, { headers: this.link.headers }).catch(() => null);
      if (answer?.ok && this.position.value === to) part.refill(new Float64Array(await answer.arrayBuffer()));
    }
  }

  get atEnd(): boolean {
    return this.report.value !== null && this.position.value >= this.report.value.ticks;
  }

  private async jump(): Promise<void> {
    while (this.wanted !== null) {
      const position = this.wanted;
      this.wanted = null;
      const value = { case: "integer", value: BigInt(position) } as const;
      await this.link.request({ case: "setParameter", value: { part: this.part, name: "Position", value: { value } } }, "ok");
      this.show(position);
      void this.refill();
    }
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
    if (!this.jumping) this.position.value = report.position;
  }
}
