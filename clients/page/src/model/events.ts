// The events of the world: faults, leases, resets, freezes, lines of the log and of controllers, results of
// checks. From the server as it happens, or from a recording all at once.
import { EventLevel, type Event } from "../link/messages";
import type { Link } from "../link/link";
import { Emitter } from "../common/signal";

const kKept = 5000;

export interface Happening {
  number: number; // counts from 0, and is no other's
  kind: string;
  text: string;
  source: string; // the part that it concerns, and the client or program that tells it
  level: EventLevel;
  era: bigint;
  timeS: number; // simulated, of its era
  position: number | null; // in a recording: ticks since its beginning
}

// As the server tells them of a recording (server/gateway/playback.cc).
interface RecordedEvent {
  position: number;
  era: number;
  time_ns: number;
  level: string;
  kind: string;
  part: string;
  text: string;
}

export class Events {
  readonly list: Happening[] = []; // the oldest first; the newest are kept
  readonly happened = new Emitter<Happening>();
  readonly cleared = new Emitter<void>();
  private next = 0;

  constructor(private readonly link: Link) {
    link.told.on((body) => body.case === "event" && !link.recorded.value && this.take(body.value));
  }

  // Call it after each hello, once it is known whether this is a recording. The server tells what happened
  // before, too.
  async begin(): Promise<void> {
    if (this.link.recorded.value) return this.beginRecorded();
    const { events } = await this.link.request({ case: "subscribeEvents", value: { level: EventLevel.INFO } }, "events");
    this.clear();
    for (const event of events) this.take(event);
  }

  private async beginRecorded(): Promise<void> {
    const answer = await fetch("/recording/events", { headers: this.link.headers });
    if (!answer.ok) throw new Error(`The recording's events cannot be read: ${await answer.text()}`);
    const { left_out: leftOut, events } = (await answer.json()) as { left_out: number; events: RecordedEvent[] };
    this.clear();
    for (const { kind, text, part, level, era, time_ns: timeNs, position } of events)
      this.add({ kind, text, source: part, level: levelNamed(level), era: BigInt(era), timeS: timeNs / 1e9, position });
    const last = this.list.at(-1);
    if (leftOut > 0 && last) this.add({ ...last, kind: "events_lost", text: `${leftOut} later events are not shown`, source: "", level: EventLevel.WARNING });
  }

  private clear(): void {
    this.list.length = 0;
    this.cleared.emit();
  }

  private take(event: Event): void {
    const { kind, text, era } = event;
    this.add({ kind, text, era, source: [event.part, event.source].filter(Boolean).join(" · "), level: levelOf(event), timeS: Number(event.simTimeNs) / 1e9, position: null });
  }

  private add(event: Omit<Happening, "number">): void {
    const happening = { ...event, number: this.next++ };
    this.list.push(happening);
    if (this.list.length > kKept) this.list.shift();
    this.happened.emit(happening);
  }
}

// Events that are told to everybody may have no level of their own.
const kGrave = new Set(["frozen", "lease_lost", "lockstep_timeout", "emergency_stop", "shutdown"]);

function levelOf({ kind, level }: Event): EventLevel {
  if (level !== EventLevel.UNSPECIFIED) return level;
  return kGrave.has(kind) ? EventLevel.WARNING : EventLevel.INFO;
}

function levelNamed(name: string): EventLevel {
  return { debug: EventLevel.DEBUG, warning: EventLevel.WARNING, error: EventLevel.ERROR }[name] ?? EventLevel.INFO;
}
