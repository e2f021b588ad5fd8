// The link to visumd. It connects, says why when the connection is lost, and tries again by itself. All other
// files of the page talk to the server through it.
import { Emitter, Signal } from "../common/signal";
import { Connection, kLookMs, needsToken } from "./connection";
import { LostError, Role, type Body, type BodyCase, type BodyOf, type RequestInit, type Welcome } from "./messages";

export type LinkState =
  | { kind: "connecting" }
  | { kind: "open"; welcome: Welcome }
  | { kind: "token"; reason: string } // waits until the user gives one
  | { kind: "lost"; reason: string; since: number };

const kFirstRetryMs = 250;
const kLastRetryMs = 2000;

export class Link {
  readonly state = new Signal<LinkState>({ kind: "connecting" });
  readonly told = new Emitter<Body>();
  // A recording is shown: the user can move in its time, and change nothing
  readonly recorded = new Signal<boolean>(false);
  role = Role.ADMIN;
  readonly name: string;
  private token = "";
  private connection: Connection | null = null;
  private retryMs = kFirstRetryMs;
  private retry = 0;
  private receivedBefore = 0;

  constructor(private readonly url: string, name: string) {
    this.name = name;
    setInterval(() => this.welcome && this.connection?.look(), kLookMs);
  }

  open(): void {
    clearTimeout(this.retry);
    if (this.state.value.kind !== "lost") this.state.value = { kind: "connecting" };
    this.connection = new Connection(this.url, { name: this.name, role: this.role, token: this.token }, {
      opened: (welcome) => this.opened(welcome),
      told: (body) => this.told.emit(body),
      closed: (reason) => this.closed(reason),
    });
  }

  // For data fetched from the same server beside the session.
  get headers(): Record<string, string> {
    return this.token === "" ? {} : { Authorization: `Bearer ${this.token}` };
  }

  useToken(token: string): void {
    this.token = token;
    this.open();
  }

  // Starts a new session with another role. Leases that are not released before are lost: see
  // Parts.releaseAll().
  useRole(role: Role): void {
    this.role = role;
    this.connection?.close();
  }

  request<C extends BodyCase>(request: RequestInit, expected: C): Promise<BodyOf<C>> {
    if (!this.connection) return Promise.reject(new LostError("not connected"));
    return this.connection.request(request, expected);
  }

  get welcome(): Welcome | null {
    return this.state.value.kind === "open" ? this.state.value.welcome : null;
  }
  get mayCommand(): boolean {
    return !this.recorded.value && (this.welcome?.role ?? Role.OBSERVER) >= Role.CONTROLLER;
  }
  get mayChangeWorld(): boolean {
    return !this.recorded.value && this.welcome?.role === Role.ADMIN;
  }
  get received(): number {
    return this.receivedBefore + (this.connection?.received ?? 0);
  }

  private opened(welcome: Welcome): void {
    this.retryMs = kFirstRetryMs;
    this.state.value = { kind: "open", welcome };
  }

  private closed(reason: Error): void {
    this.receivedBefore += this.connection?.received ?? 0;
    this.connection = null;
    if (needsToken(reason)) {
      this.state.value = { kind: "token", reason: reason.message };
      return;
    }
    const before = this.state.value;
    const since = before.kind === "lost" ? before.since : Date.now();
    this.state.value = { kind: "lost", reason: reason.message, since };
    this.retry = window.setTimeout(() => this.open(), this.retryMs);
    this.retryMs = Math.min(2 * this.retryMs, kLastRetryMs);
  }
}
