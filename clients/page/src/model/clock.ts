// The state of the server's time, asked for twice a second, and the user's commands: run, pause, step, speed,
// reset.
import type { Link } from "../link/link";
import type { RequestInit, ResetScope, ServerStatus } from "../link/messages";
import { poll } from "./poll";
import { Signal } from "../common/signal";

const kPeriodMs = 500;
const kPieceNs = 100e6; // simulated

export class Clock {
  readonly status = new Signal<ServerStatus | null>(null);
  readonly stepping = new Signal<boolean>(false); // more pieces of a long step will follow
  private asked = 0; // counts the user's commands; a newer command ends a step

  constructor(private readonly link: Link) {
    poll(() => this.refresh(), kPeriodMs);
  }

  async refresh(): Promise<void> {
    if (!this.link.welcome) return;
    const status = await this.link.request({ case: "status", value: {} }, "status").catch(() => null);
    if (status) this.status.value = status;
  }

  pause = () => this.insteadOfStep({ case: "pause", value: {} });
  resume = () => this.insteadOfStep({ case: "resume", value: {} });
  reset = (scope: ResetScope) => this.insteadOfStep({ case: "reset", value: { scope } });
  restore = (snapshot: bigint) => this.insteadOfStep({ case: "restoreSnapshot", value: { snapshot } });
  setSpeed = (factor: number) => this.act({ case: "setSpeed", value: { factor } });

  // Steps in pieces, because every request of this session waits behind a Step. Pause, Run, Reset or another
  // step takes effect after the present piece.
  async step(ticks: number): Promise<void> {
    const mine = ++this.asked;
    const piece = Math.max(1, Math.round(kPieceNs / Number(this.link.welcome?.tickNs ?? 1_000_000n)));
    this.stepping.value = ticks > piece;
    try {
      for (let at = -1n, left = ticks; left > 0 && mine === this.asked; left -= piece) {
        const { tick } = await this.link.request({ case: "step", value: { ticks: BigInt(Math.min(left, piece)) } }, "advanced");
        if (tick <= at) break; // the end of a recording, or another client has reset the world
        at = tick;
      }
    } finally {
      if (mine === this.asked) this.stepping.value = false;
    }
    await this.refresh();
  }

  private insteadOfStep(request: RequestInit): Promise<void> {
    this.asked += 1;
    this.stepping.value = false;
    return this.act(request);
  }

  private async act(request: RequestInit): Promise<void> {
    await this.link.request(request, "ok");
    await this.refresh();
  }
}
