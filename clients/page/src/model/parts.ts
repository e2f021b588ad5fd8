// All parts of the server, kept up to date: who holds which lease, and samples as often as somebody needs them.
import { clone, equals } from "@bufbuild/protobuf";
import type { Link } from "../link/link";
import { PartDescriptionSchema, type Event, type PartDescription } from "../link/messages";
import { Part, type Port } from "./part";
import { poll } from "./poll";
import { Emitter, Signal } from "../common/signal";

const kRefreshMs = 1000;
const kRecording = "recording";

export class Parts {
  readonly list = new Signal<Part[]>([]);
  readonly plotsChanged = new Emitter<void>(); // more or other ports are plotted: see plotted()
  steering: string | null = null; // the part that moves through a recording, which is not one of the list
  private realTimeFactor = 1;

  constructor(private readonly link: Link) {
    link.told.on((body) => {
      if (body.case === "partSample") this.find(body.value.part)?.take(body.value);
      if (body.case === "event") this.onEvent(body.value);
    });
    poll(() => this.refreshHolders(), kRefreshMs);
  }

  // After each hello: everything anew, but parts that are the same as before stay (plots and panels point at them).
  async begin(): Promise<void> {
    const { parts } = await this.link.request({ case: "listParts", value: {} }, "parts");
    const list: Part[] = [];
    for (const part of this.list.value) part.leaseLost(); // with the session that held it
    this.steering = parts.find(({ kind }) => kind === kRecording)?.name ?? null;
    for (const { name, kind } of parts) {
      if (kind === kRecording) continue;
      const description = await this.link.request({ case: "describePart", value: { part: name } }, "partDescription");
      const before = this.find(name);
      const same = before && equals(PartDescriptionSchema, lasting(before.description), lasting(description));
      const part = same ? before : new Part(this.link, description);
      part.holder.value = description.leaseOwner;
      part.forgetSubscription();
      list.push(part);
    }
    this.list.value = list;
    await this.subscribe();
  }

  find(name: string): Part | undefined {
    return this.list.value.find((part) => part.name === name);
  }

  port(part: string, port: string): Port | undefined {
    return this.find(part)?.port(port);
  }

  // In good order: the last values go on holding. What a session still holds as it ends is lost, and the part stops.
  async releaseAll(): Promise<void> {
    if (!this.link.welcome) return;
    const leased = this.list.value.filter((part) => part.leased.value);
    const ends = await Promise.allSettled(leased.map((part) => part.release()));
    for (const end of ends) if (end.status === "rejected") throw end.reason;
  }

  async adaptTo(realTimeFactor: number): Promise<void> {
    this.realTimeFactor = realTimeFactor;
    await this.subscribe();
  }

  // After a plot began or ended to want every tick.
  async plotted(): Promise<void> {
    this.plotsChanged.emit();
    await this.subscribe();
  }

  private async subscribe(): Promise<void> {
    const welcome = this.link.welcome;
    if (!welcome) return;
    for (const part of this.list.value) await part.subscribe(Number(welcome.tickNs), this.realTimeFactor);
  }

  private onEvent(event: Event): void {
    if (event.kind !== "lease_lost") return;
    const part = this.find(event.part);
    if (part && !part.leased.value) part.holder.value = "";
    void this.refreshHolders();
  }

  private async refreshHolders(): Promise<void> {
    if (!this.link.welcome || document.hidden) return;
    const { parts } = await this.link.request({ case: "listParts", value: {} }, "parts").catch(() => ({ parts: [] }));
    for (const { name, leaseOwner } of parts) {
      const part = this.find(name);
      if (!part) continue;
      if (part.leased.value && leaseOwner !== this.link.name) part.leaseLost();
      part.holder.value = leaseOwner;
    }
  }
}

// Without what comes and goes while the part is the same.
function lasting(description: PartDescription): PartDescription {
  const bare = clone(PartDescriptionSchema, description);
  bare.leaseOwner = "";
  for (const parameter of bare.parameters) delete parameter.value;
  for (const board of bare.blackboards) board.elements = 0n;
  return bare;
}
