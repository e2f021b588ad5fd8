// The server's state, asked for twice a second, and what a user does with its time.
import type { Link } from "../link/link";
import type { RequestInit, ServerStatus } from "../link/messages";
import { poll } from "./poll";
import { Signal } from "../common/signal";

const kPeriodMs = 500;
const kPieceNs = 100e6; // simulated

export class Clock {
  readonly status = new Signal<ServerStatus | null>(null);
  readonly stepping = new Signal<boolean>(false); // pieces of a long step are still to come
  private asked = 0; // counts what the user asks of time: what is newer ends a step

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
  reset = () => this.insteadOfStep({ case: "reset", value: {} });
  setSpeed = (factor: number) => this.act({ case: "setSpeed", value: { factor } });

  // In pieces, because all that this session asks waits behind a Step. Pause, Run, Reset or another step ends it with its piece.
  async step(ticks: number): Promise<void> {
    const mine = ++this.asked;
    const piece = Math.max(1, Math.round(kPieceNs / Number(this.link.welcome?.tickNs ?? 1_000_000n)));
    this.stepping.value = ticks > piece;
    try {
      for (let at = -1n, left = ticks; left > 0 && mine === this.asked; left -= piece) {
        const { tick } = await this.link.request({ case: "step", value: { ticks: BigInt(Math.min(left, piece)) } }, "advanced");
        if (tick <= at) break; // a recording's end, or somebody has reset the world
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
