// The state of a part in words: from its port "Part State", and, where it is in fault, from its parameters,
// which say why. Parts without such a port have no words.
import type { Link } from "../link/link";
import type { ParameterDescription, ParameterValue } from "../link/messages";
import { inWords } from "../ui/numbers";
import { toneOf, type Tone } from "../ui/tone";
import type { Part, Port } from "../model/part";
import { poll } from "../model/poll";
import { actualOf, kDesired } from "../model/desired";
import { Signal } from "../common/signal";

export const kEmergencyStop = "Emergency Stop";
const kTripped = "Tripped"; // protocol/part_description.h
const kSupply = "Supply Voltage"; // hwparts/servo_group/parameters.cc
const kPeriodMs = 700;
const kWithinS = 0.3; // of simulated time: so soon a part acts on what it is told,
const kWithinMs = 5000; // and so long the page waits for that
const kNear: Record<string, number> = { rad: 0.01, m: 0.001 }; // a drive is where it is commanded
// States in which nothing moves on command
const kHinders = ["fault", "controller lost", "halted", "disabled"];
// Faults of the power stage, which end only after the supply was off (hwparts/README.md)
const kPowerStage = /\b(INTEGRALERR|FET_TEMP)\b/;
const kSupplyOff = /\bPOW_VOLT_ERR\b/;

export interface PartState {
  words: string;
  tone: Tone;
  reason: string; // empty: none is known, or none is needed
  stopped: boolean; // its emergency stop is pressed
}

// The input that ends a state, and the words for it.
const kWayOut: Record<string, { text: string; port: string }> = {
  "not homed": { text: "press Home", port: "Home" },
  halted: { text: "press Reset", port: "Reset" },
  "controller lost": { text: "press Reset", port: "Reset" },
  fault: { text: "press Reset", port: "Reset" },
  disabled: { text: "set Execution Enable", port: "Execution Enable" },
};

// The state of a part in words; empty where it has none.
export function stateWords(part: Part): string {
  const port = statePort(part);
  return port ? inWords(port.description, part.value(port)) : "";
}

// Why a part does not move on command now; empty: it does.
export function hindrance(part: Part): string {
  const words = stateWords(part);
  const named = words !== "fault" ? words : anyDrive(part, kSupplyOff) ? "without supply, as after Stop" : "in fault";
  return kHinders.includes(words) ? `${part.name} is ${named}; see the bar above` : "";
}

const statePort = (part: Part): Port | undefined =>
  part.ports.find(({ side, description }) => side === "output" && description.name === "Part State" && description.values.length > 0);

// True if any drive of the part is in one of these states.
const anyDrive = (part: Part, expression: RegExp): boolean =>
  part.ports.some((port) => port.side === "output" && port.description.bits.length > 0 && expression.test(inWords(port.description, part.value(port))));

export class PartWatch {
  readonly state = new Signal<PartState>({ words: "", tone: "plain", reason: "", stopped: false });
  private readonly port: Port | undefined;
  private tripped = "";
  private stopped = false;
  private readonly stops: (() => void)[];

  constructor(private readonly link: Link, readonly part: Part) {
    this.port = statePort(part);
    const ask = poll(() => this.ask(), kPeriodMs);
    this.stops = [ask, part.sampled.on(() => this.show())];
  }

  dispose(): void {
    for (const stop of this.stops) stop();
  }

  get hasStop(): boolean {
    return this.has(kEmergencyStop);
  }

  private has(parameter: string): boolean {
    return this.part.description.parameters.some(({ name }) => name === parameter);
  }

  // The input that ends the present state; undefined: there is none.
  get wayOut(): Port | undefined {
    const { words } = this.state.value;
    return this.part.port(kWayOut[words]?.port ?? "");
  }

  // True if Reset ends the present state only after the supply was off, which this page can switch. At a real
  // part a hand does that.
  get needsSupplyOff(): boolean {
    return this.state.value.words === "fault" && this.has(kSupply) && anyDrive(this.part, kPowerStage);
  }

  // Ends the present state by its input, which the page may write. Throws where that did not help, with the
  // reason.
  async end(): Promise<void> {
    const { wayOut, part } = this;
    if (!wayOut) return;
    if (this.needsSupplyOff) await this.switchSupply();
    const resets = wayOut.description.name === "Reset";
    if (resets) await letGo(part);
    const { words } = this.state.value;
    const isSwitch = wayOut.description.maximum === 1;
    await part.write(wayOut, isSwitch ? 1 : part.commanded(wayOut) + 1);
    if (!resets || (await this.comes(() => stateWords(part) !== words))) return;
    await this.ask(); // how long to wait may have changed
    throw new Error(`${part.name}: Reset did not end the ${words}. ${this.state.value.reason}`);
  }

  // Not by the emergency stop, which somebody else may press meanwhile.
  private async switchSupply(): Promise<void> {
    const { parameters } = await this.link.request({ case: "getParameters", value: { part: this.part.name } }, "parameters");
    const before = parameters.find(({ name }) => name === kSupply)?.value;
    if (!before) return;
    await this.set(kSupply, { case: "number", value: 0 });
    const off = await this.comes(() => anyDrive(this.part, kSupplyOff));
    await this.set(kSupply, before.value);
    if (!off) throw new Error(`The supply of ${this.part.name} was not seen off; let the world run, and try again`);
  }

  // Waits for what a part shows soon.
  private comes(condition: () => boolean): Promise<boolean> {
    const time = () => Number(this.part.sample?.simTimeNs ?? 0n) / 1e9;
    const from = time();
    return new Promise((done) => {
      const end = (came: boolean) => (clearTimeout(timer), stop(), done(came));
      const timer = setTimeout(() => end(condition()), kWithinMs);
      const stop = this.part.sampled.on(() => (condition() || Math.abs(time() - from) > kWithinS) && end(condition()));
    });
  }

  async press(on: boolean): Promise<void> {
    await this.set(kEmergencyStop, { case: "flag", value: on });
    this.stopped = on;
    this.show();
  }

  private async set(name: string, value: ParameterValue["value"]): Promise<void> {
    await this.link.request({ case: "setParameter", value: { part: this.part.name, name, value: { value } } }, "ok");
  }

  // Parameters say more than ports do, but cost more. They are asked for only while something is wrong.
  private async ask(): Promise<void> {
    const wrong = this.state.value.tone === "bad" || this.state.value.stopped;
    if (!wrong || document.hidden || !this.link.welcome) return;
    const answer = await this.link.request({ case: "getParameters", value: { part: this.part.name } }, "parameters").catch(() => null);
    if (!answer) return;
    this.tripped = textOf(answer.parameters, kTripped);
    this.stopped = answer.parameters.some(({ name, value }) => name === kEmergencyStop && value?.value.value === true);
    this.show();
  }

  private show(): void {
    const value = this.port ? this.part.value(this.port) : NaN;
    const words = this.port ? inWords(this.port.description, value) : "";
    const tone = toneOf(words);
    if (tone !== "bad" && !this.stopped) this.tripped = "";
    const next = this.stopped
      ? { words: "stopped", tone: "bad" as const, reason: "the emergency stop is pressed", stopped: true }
      : { words, tone, reason: reasonOf(words, this.tripped), stopped: false };
    const now = this.state.value;
    if (next.words !== now.words || next.reason !== now.reason || next.stopped !== now.stopped) this.state.value = next;
  }
}

// Pure.
export function reasonOf(words: string, tripped: string): string {
  const way = kWayOut[words]?.text ?? "";
  const why = tripped.split("\n").filter(Boolean).join("; ");
  return why === "" ? way : why;
}

// Gives up what was commanded before a fault: a part that shows "ready" is where it is commanded.
async function letGo(part: Part): Promise<void> {
  for (const port of part.ports.filter(({ side, description }) => side === "input" && kDesired.test(description.group))) {
    const actual = part.port(actualOf(port.description.name));
    const value = actual ? part.value(actual) : NaN;
    if (Math.abs(part.commanded(port) - value) > (kNear[port.description.unit] ?? Infinity)) await part.write(port, value);
  }
}

function textOf(parameters: readonly ParameterDescription[], wanted: string): string {
  const value = parameters.find(({ name }) => name === wanted)?.value?.value;
  return value?.case === "text" ? value.value : "";
}
