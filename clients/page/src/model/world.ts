// The world as visumd describes it, and its latest sample.
import type { Link } from "../link/link";
import type { MeshData, TextureData, WorldDescription, WorldSample } from "../link/messages";
import { Playhead } from "./playhead";
import { PoseBuffer } from "./poses";
import { Emitter, Signal } from "../common/signal";

const kFramesPerSecond = 60;
const kDelayMs = 40; // the age of what is shown: two samples and some jitter
const kNsPerMs = 1e6;

export class World {
  readonly description = new Signal<WorldDescription | null>(null);
  readonly sampled = new Emitter<WorldSample>();
  sample: WorldSample | null = null;
  shownMs = -Infinity; // the simulated time that is drawn
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

  // Call it after each hello.
  async begin(): Promise<void> {
    this.everyTicks = 0;
    this.buffer.clear();
    this.playhead.reset();
    await this.describe();
    await this.adaptTo(1);
  }

  // Asks for about 60 samples a second of wall time, however fast the world runs.
  async adaptTo(realTimeFactor: number): Promise<void> {
    const tickNs = Number(this.link.welcome?.tickNs ?? 1_000_000n);
    const wanted = (1e9 / kFramesPerSecond / tickNs) * Math.max(realTimeFactor, 0.01);
    const every = Math.max(1, Math.floor(wanted));
    // A small change of speed is not worth a message.
    if (this.everyTicks > 0 && every < 1.5 * this.everyTicks && every > 0.6 * this.everyTicks) return;
    this.everyTicks = every;
    await this.link.request({ case: "subscribeWorld", value: { everyNTicks: every } }, "ok");
  }

  // While the world is paused no further sample comes. A page that missed the last one asks for it.
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

  // Writes the poses to draw at wall time `now`. Returns false if there are none yet.
  posesAt(now: number, out: Float64Array): boolean {
    this.shownMs = this.playhead.at(now);
    return this.buffer.at(this.shownMs, out);
  }

  bodyIndex(name: string): number {
    return this.description.value?.bodies.findIndex((body) => body.name === name) ?? -1;
  }

  private async describe(): Promise<void> {
    const description = await this.link.request({ case: "describeWorld", value: {} }, "worldDescription");
    // While the world is paused, no sample brings the poses. Samples from before belong to the bodies that
    // had these numbers then.
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
    // Samples of a changed world mean nothing before its description is here.
    const description = this.description.value;
    if (sample.revision !== description?.revision || sample.poses.length !== 7 * description.bodies.length) return;
    this.sample = sample;
    this.buffer.add(time, sample.poses);
    this.playhead.heard(time, performance.now());
    this.sampled.emit(sample);
  }
}
