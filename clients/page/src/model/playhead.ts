// The simulated time to show now. The world is shown a little in the past, so that there is a sample on both
// sides of the time that is drawn. The time runs as evenly as the display does, not as the network does.
// Pure: the caller gives the wall time.

export class Playhead {
  private anchorSim = 0; // the simulated time at anchorWall
  private anchorWall = 0;
  private rate = 1; // simulated per wall time, measured from samples
  private latest = -Infinity;
  private shown = -Infinity;
  private started = false;

  // `delay`: wall ms to stay behind.
  constructor(private readonly delay: number) {}

  reset(): void {
    this.started = false;
    this.latest = this.shown = -Infinity;
  }

  // Call it when a sample of simulated time `sim` (ms) came at wall time `wall` (ms).
  heard(sim: number, wall: number): void {
    if (!this.started || sim < this.latest) {
      this.reset();
      this.started = true;
      this.rate = 0;
      this.anchorSim = sim;
    } else if (wall > this.anchorWall) {
      // After a pause the old rate means nothing. Otherwise follow the new rate slowly.
      const observed = (sim - this.latest) / (wall - this.anchorWall);
      const gap = wall - this.anchorWall > 4 * this.delay;
      this.rate = gap ? 0 : this.rate + 0.1 * (observed - this.rate);
      const expected = this.anchorSim + this.rate * (wall - this.anchorWall);
      this.anchorSim = gap ? sim : expected + 0.2 * (sim - expected);
    }
    this.anchorWall = wall;
    this.latest = sim;
  }

  // The simulated time (ms) to show at wall time `wall`. It never passes the last sample, and never goes
  // back.
  at(wall: number): number {
    if (!this.started) return -Infinity;
    const silence = wall - this.anchorWall;
    const steady = this.anchorSim + this.rate * (silence - this.delay);
    // When samples stop, show what is known to its end.
    const target = silence > 2 * this.delay ? this.latest : Math.min(steady, this.latest);
    this.shown = Math.max(this.shown, target);
    return this.shown;
  }
}
