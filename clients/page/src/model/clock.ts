// The server's state, asked for twice a second, and what a user does with its time.
import type { Link } from "../link/link";
import type { RequestInit, ServerStatus } from "../link/messages";
import { Signal } from "./signal";

const kPeriodMs = 500;

export class Clock {
  readonly status = new Signal<ServerStatus | null>(null);

  constructor(private readonly link: Link) {
    setInterval(() => void this.refresh(), kPeriodMs);
  }

  async refresh(): Promise<void> {
    if (!this.link.welcome) return;
    const status = await this.link.request({ case: "status", value: {} }, "status").catch(() => null);
    if (status) this.status.value = status;
  }

  pause = () => this.act({ case: "pause", value: {} });
  resume = () => this.act({ case: "resume", value: {} });
  reset = () => this.act({ case: "reset", value: {} });
  setSpeed = (factor: number) => this.act({ case: "setSpeed", value: { factor } });

  async step(ticks: number): Promise<void> {
    await this.link.request({ case: "step", value: { ticks: BigInt(ticks) } }, "advanced");
    await this.refresh();
  }

  private async act(request: RequestInit): Promise<void> {
    await this.link.request(request, "ok");
    await this.refresh();
  }
}
