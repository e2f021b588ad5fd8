// All parts of the server, kept up to date: the holders of leases, and samples as often as the page needs
// them.
import { clone, equals } from "@bufbuild/protobuf";
import type { Link } from "../link/link";
import { ErrorCode, PartDescriptionSchema, RequestError, type Event, type PartDescription } from "../link/messages";
import { Part, type Port } from "./part";
import { poll } from "./poll";
import { Emitter, Signal } from "../common/signal";

const kRefreshMs = 1000;
const kRecording = "recording";

export class Parts {
  readonly list = new Signal<Part[]>([]);
  readonly plotsChanged = new Emitter<void>(); // more or other ports are plotted: see plotted()
  readonly beside = new Signal<string>(""); // the name of a second recording; empty: there is none
  steering: string | null = null; // the part that steers a recording; it is not in the list
  private realTimeFactor = 1;
  private reading: Promise<void> = Promise.resolve();

  constructor(private readonly link: Link) {
    link.told.on((body) => {
      if (body.case === "partSample") this.find(body.value.part)?.take(body.value);
      if (body.case === "event") this.onEvent(body.value);
    });
    poll(() => this.refreshHolders(), kRefreshMs);
    // The server ends a lease with its session, and nobody commands through a link that is gone.
    link.state.watch(({ kind }) => kind !== "open" && this.forgetLeases());
  }

  private forgetLeases(): void {
    for (const part of this.list.value) if (part.leased.value) part.leaseLost();
  }

  // Call it after each hello. Reads everything anew. A part that is the same as before stays the same object,
  // because plots and panels point at it.
  begin(): Promise<void> {
    for (const part of this.list.value) {
      part.leaseLost(); // leases end with the session that held them
      part.forgetSubscription();
    }
    return this.read();
  }

  // One reading after the other: parts may come and go while they are read.
  private read(): Promise<void> {
    const next = this.reading.then(() => this.readNow());
    this.reading = next.catch(() => undefined);
    return next;
  }

  private async readNow(): Promise<void> {
    const { parts } = await this.link.request({ case: "listParts", value: {} }, "parts");
    const list: Part[] = [];
    this.steering = parts.find(({ kind }) => kind === kRecording)?.name ?? null;
    for (const { name, kind } of parts) {
      if (kind === kRecording) continue;
      const description = await this.link.request({ case: "describePart", value: { part: name } }, "partDescription");
      const before = this.find(name);
      const same = before && equals(PartDescriptionSchema, lasting(before.description), lasting(description));
      const part = same ? before : new Part(this.link, description);
      part.holder.value = description.leaseOwner;
      list.push(part);
    }
    const is = this.list.value;
    if (list.length !== is.length || list.some((part, i) => part !== is[i])) this.list.value = list;
    await this.subscribe();
  }

  get mayCommand(): boolean {
    return this.link.mayCommand;
  }

  find(name: string): Part | undefined {
    return this.list.value.find((part) => part.name === name);
  }

  port(part: string, port: string): Port | undefined {
    return this.find(part)?.port(port);
  }

  // Releases all leases in good order, so that the parts keep the last values. A lease that a session still
  // holds when it ends counts as lost, and its part stops.
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

  // Call it when a plot has begun or ended to want every tick.
  async plotted(): Promise<void> {
    this.plotsChanged.emit();
    await this.subscribe();
  }

  private async subscribe(): Promise<void> {
    const welcome = this.link.welcome;
    if (!welcome) return;
    for (const part of this.list.value) await part.subscribe(Number(welcome.tickNs), this.realTimeFactor).catch(unlessGone);
  }

  private onEvent(event: Event): void {
    // Models come and go with their parts. One that goes while it is read is not there the next time.
    if (event.kind === "world_changed") void this.read().catch(() => undefined);
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

// A part may go with its model or scene before the list tells it.
function unlessGone(error: unknown): void {
  if (!(error instanceof RequestError && error.code === ErrorCode.ERROR_UNKNOWN_NAME)) throw error;
}

// The description without the fields that change while the part stays the same.
function lasting(description: PartDescription): PartDescription {
  const bare = clone(PartDescriptionSchema, description);
  bare.leaseOwner = "";
  for (const parameter of bare.parameters) delete parameter.value;
  for (const board of bare.blackboards) board.elements = 0n;
  return bare;
}
