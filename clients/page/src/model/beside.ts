// A second recording beside the one that is shown (`visumd replay A --view --beside B`): where the two
// differ, by the server's comparison, and where B's bodies are while A stands at its position.
import { Emitter } from "../common/signal";
import { PoseBuffer } from "./poses";

export interface DifferentPort {
  part: string;
  port: string;
  position: number; // ticks since the beginning, of the first difference
  tick: number; // of the world
  a: string; // numbers with all their digits, there
  b: string;
  max_abs: string; // so far
  max_tick: number;
}
export interface BesideReport {
  file: string;
  ticks: number;
  compared: number;
  over: boolean; // all is compared, or it cannot go on
  damage: string;
  settings: string[]; // how the worlds were made differently
  only_a: string[]; // ports
  only_b: string[];
  ports: DifferentPort[]; // the first of them, by their first difference
  port_count: number; // all of them
  first?: { position: number; tick: number };
}

const kSaidPorts = 2;

// Six digits are enough to read. Pure.
export function inShort(text: string): string {
  const value = Number(text);
  if (!Number.isFinite(value)) return text;
  return value !== 0 && Math.abs(value) < 1e-3 ? value.toExponential(3) : String(Number(value.toPrecision(6)));
}

// As `visum compare` says it (clients/visum/compare/forms.cc). Pure.
export function whereTheyPart(ticks: number, { file, compared, over, damage, first, only_a, only_b, port_count, ports, ticks: ticksB }: BesideReport): string {
  const count = (number: number) => number.toLocaleString("en");
  const end = damage === "" ? "" : ` It ends there: ${damage}.`;
  if (!first) {
    if (!over) return `Compared with ${file}: equal in ${count(compared)} of ${count(Math.max(ticks, ticksB))} ticks so far.`;
    const other = only_a.length + only_b.length > 0;
    return (other ? "Not the same ports; those that both have are equal in all ticks." : `Equal: all ${count(compared)} ticks.`) + end;
  }
  const lengths = ticks === ticksB ? "" : ` A has ${count(ticks)} ticks, B ${count(ticksB)}.`;
  const there = ports.filter(({ position }) => position === first.position).map(({ part, port, a, b }) => `${part}, ${port}: A ${inShort(a)}, B ${inShort(b)}`);
  if (there.length > kSaidPorts) there.splice(kSaidPorts, there.length, `${there.length - kSaidPorts} more`);
  const what = there.length > 0 ? ` ${there.join("; ")}.` : port_count === 0 ? " No port differs, but the state or the length does." : " The state differs there, and no port yet.";
  return `They part at tick ${count(first.tick)}.${what}${lengths}${end}`;
}

const kHead = 2; // the position, and A's simulated seconds
const kNumbers = 9; // of each body: its pose in B, and how far that is from the pose in A: m, rad
const kPose = 7;

const kLeast = 5e-5; // m: shown as 0.1 mm at least; 20 of them as rad are 0.1°

export interface Apart {
  metres: number;
  radians: number; // both 0: the same bits; both NaN: B has no such body
}

// B's bodies, in the order of A's.
export class BesideBodies {
  readonly changed = new Emitter<void>();
  apart: Apart[] = [];
  position = -1;
  private readonly buffer = new PoseBuffer();

  // The blackboard Beside of the part that steers the recording (server/gateway/beside.h).
  take(data: Uint8Array): void {
    const numbers = new Float64Array(data.slice().buffer);
    const [position = -1, seconds = 0] = numbers;
    const bodies = Math.floor((numbers.length - kHead) / kNumbers);
    const poses: number[] = [];
    this.apart = [];
    for (let body = 0; body < bodies; ++body) {
      const at = kHead + body * kNumbers;
      poses.push(...numbers.subarray(at, at + kPose));
      this.apart.push({ metres: numbers[at + kPose]!, radians: numbers[at + kPose + 1]! });
    }
    this.position = position;
    this.buffer.add(1000 * seconds, poses);
    this.changed.emit();
  }

  // Writes the poses at a simulated time (ms). Returns false if none are known.
  posesAt(time: number, out: Float64Array): boolean {
    return this.buffer.at(time, out);
  }
}

export const isApart = ({ metres, radians }: Apart): boolean => metres > 0 || radians > 0;
// So far that a ghost shows something. One at the same place would only colour the body.
export const isToBeSeen = ({ metres, radians }: Apart): boolean => metres >= kLeast || radians >= 20 * kLeast;

// The bodies that are elsewhere in B, the farthest first. Pure.
export function apartInWords(names: readonly string[], apart: readonly Apart[], most: number): string {
  const found = names.map((name, i) => ({ name, ...(apart[i] ?? { metres: 0, radians: 0 }) }));
  const missing = found.filter(({ metres }) => Number.isNaN(metres));
  const far = found.filter(isApart).sort((a, b) => b.metres - a.metres || b.radians - a.radians);
  const texts = far.slice(0, most).map(({ name, metres, radians }) => `${name} ${distance(metres, radians)}`);
  if (far.length > most) texts.push(`${far.length - most} more`);
  const lacks = missing.length === 0 ? "" : `; not in B: ${missing.slice(0, most).map(({ name }) => name).join(", ")}`;
  return (far.length === 0 ? "all bodies are where they are in A" : texts.join(", ")) + lacks;
}

function distance(metres: number, radians: number): string {
  const turned = `turned ${((radians * 180) / Math.PI).toFixed(1)}°`;
  if (metres >= 1) return `${metres.toFixed(2)} m`;
  if (metres >= kLeast) return `${(1000 * metres).toFixed(1)} mm`;
  return radians >= 20 * kLeast ? turned : "less than 0.1 mm";
}
