// Plays taught poses: writes one, waits until the part is there, and goes on to the next.
import { Signal } from "../common/signal";
import { neighbours } from "../model/neighbours";
import type { Part, Port } from "../model/part";
import { actualOf } from "../model/desired";
import type { TaughtPose } from "./teach";

const kPollMs = 50;
const kLongestS = 60; // of simulated time for one pose
const kNear: Record<string, number> = { rad: 0.005, m: 0.0005 };

export class Player {
  readonly playing = new Signal<number>(-1); // the pose under way; -1: none
  private run = 0; // counts the runs; a newer one ends the older

  // Throws where a pose cannot be written, or is not reached.
  async play(part: Part, poses: readonly TaughtPose[], first: number, last: number, loop: () => boolean): Promise<void> {
    const mine = ++this.run;
    try {
      do {
        for (let i = first; i <= last; ++i) {
          this.playing.value = i;
          await goTo(part, poses[i]!.values);
          if (!(await this.arrives(part, poses[i]!, mine))) return;
        }
      } while (loop() && mine === this.run);
    } finally {
      if (mine === this.run) this.playing.value = -1;
    }
  }

  stop(): void {
    ++this.run;
    this.playing.value = -1;
  }

  // False: the run was ended.
  private async arrives(part: Part, { name, values }: TaughtPose, mine: number): Promise<boolean> {
    const time = () => Number(part.sample?.simTimeNs ?? 0n) / 1e9;
    const from = time();
    for (;;) {
      if (mine !== this.run) return false;
      if (!part.leased.value) throw new Error(`control of '${part.name}' is lost`);
      if (Object.entries(values).every(([port, value]) => isThere(part, port, value))) return true;
      if (time() < from) return false; // the world was reset
      if (time() > from + kLongestS) throw new Error(`'${name}' was not reached within ${kLongestS} s`);
      await new Promise((done) => setTimeout(done, kPollMs));
    }
  }
}

function isThere(part: Part, port: string, value: number): boolean {
  const actual = part.port(actualOf(port));
  return !actual || Math.abs(part.value(actual) - value) <= (kNear[actual.description.unit] ?? Infinity);
}

async function goTo(part: Part, values: Record<string, number>): Promise<void> {
  const ports = Object.keys(values).map((name) => part.port(name)).filter((port): port is Port => port !== undefined);
  for (const run of neighbours(ports)) await part.writeValues(run[0]!, run.map((port) => values[port.description.name]!));
}
