// The world as visumd tells of it: its description, and its latest sample.
import type { Link } from "../link/link";
import type { MeshData, TextureData, WorldDescription, WorldSample } from "../link/messages";
import { Playhead } from "./playhead";
import { PoseBuffer } from "./poses";
import { Emitter, Signal } from "../common/signal";

const kFramesPerSecond = 60;
const kDelayMs = 40; // what is shown is so old: two samples and some jitter
const kNsPerMs = 1e6;

export class World {
  readonly description = new Signal<WorldDescription | null>(null);
  readonly sampled = new Emitter<WorldSample>();
  sample: WorldSample | null = null;
  private readonly buffer = new PoseBuffer();
  private readonly playhead = new Playhead(kDelayMs);
  private era = -1n;
  private everyTicks = 0;

  constructor(private readonly link: Link) {
    link.told.on((body) => {
      if (body.case === "worldSample") this.take(body.value);
      if (body.case === "event" && body.value.kind === "world_changed") void this.describe();
    });
  }

  // After each hello.
  async begin(): Promise<void> {
    this.everyTicks = 0;
    this.buffer.clear();
    this.playhead.reset();
    await this.describe();
    await this.adaptTo(1);
  }

  // Samples come about 60 times a second of wall time, however fast the world runs.
  async adaptTo(realTimeFactor: number): Promise<void> {
    const tickNs = Number(this.link.welcome?.tickNs ?? 1_000_000n);
    const wanted = (1e9 / kFramesPerSecond / tickNs) * Math.max(realTimeFactor, 0.01);
    const every = Math.max(1, Math.floor(wanted));
    // Small changes of speed are not worth a message.
    if (this.everyTicks > 0 && every < 1.5 * this.everyTicks && every > 0.6 * this.everyTicks) return;
    this.everyTicks = every;
    await this.link.request({ case: "subscribeWorld", value: { everyNTicks: every } }, "ok");
  }

  // While time stands no further sample comes: what a page that lagged did not get is asked for.
  async catchUp(simTimeNs: bigint): Promise<void> {
    if (this.sample?.simTimeNs === simTimeNs) return;
    this.take(await this.link.request({ case: "readWorld", value: {} }, "worldSample"));
  }

  mesh(index: number): Promise<MeshData> {
    return this.link.request({ case: "readMesh", value: { mesh: index } }, "mesh");
  }

  texture(index: number): Promise<TextureData> {
    return this.link.request({ case: "readTexture", value: { texture: index } }, "texture");
  }

  // The poses to draw at wall time `now`; false: none yet.
  posesAt(now: number, out: Float64Array): boolean {
    return this.buffer.at(this.playhead.at(now), out);
  }

  bodyIndex(name: string): number {
    return this.description.value?.bodies.findIndex((body) => body.name === name) ?? -1;
  }

  private async describe(): Promise<void> {
    const description = await this.link.request({ case: "describeWorld", value: {} }, "worldDescription");
    // While time stands, nobody tells the poses. Those that were told are of bodies that had these numbers before.
    const sample = await this.link.request({ case: "readWorld", value: {} }, "worldSample");
    this.buffer.clear();
    this.sample = null;
    this.description.value = description;
    this.take(sample);
  }

  private take(sample: WorldSample): void {
    if (sample.era !== this.era) {
      this.era = sample.era;
      this.buffer.clear();
      this.playhead.reset();
    }
    const time = Number(sample.simTimeNs) / kNsPerMs;
    // Before the description of a changed world is here, its samples mean nothing.
    const description = this.description.value;
    if (sample.revision !== description?.revision || sample.poses.length !== 7 * description.bodies.length) return;
    this.sample = sample;
    this.buffer.add(time, sample.poses);
    this.playhead.heard(time, performance.now());
    this.sampled.emit(sample);
  }
}
