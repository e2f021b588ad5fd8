// The number of pixels to draw: fewer while the machine is too slow to draw all of them as fast as the world
// moves, and all of them once it stands. Pure: asked once for each frame of the display.

const kSlowMs = 45; // between two pictures
const kQuickMs = 20;
const kQuickPictures = 40; // as many in a row before it tries more pixels
const kLeast = 0.4;
const kStep = 0.7;
const kStandsMs = 400;

export class Resolution {
  private share = 1; // of a side's pixels, while things move
  private drawn = 1; // of the last picture
  private last = NaN; // ms; when it was drawn
  private follows = false; // the frame before had a picture, too
  private quick = 0;

  // The share of the pixels to draw at `now` (ms); null: draw no picture. `wanted`: something moved.
  frame(now: number, wanted: boolean): number | null {
    if (wanted && this.follows) this.adapt(now - this.last);
    this.follows = wanted;
    const stands = !wanted && this.drawn < 1 && now - this.last > kStandsMs;
    if (!wanted && !stands) return null;
    this.last = now;
    this.drawn = stands ? 1 : this.share;
    return this.drawn;
  }

  // Twice the time asks for half the pixels: the square root of a half on each side. It is not done at once,
  // because one picture may be late by chance.
  private adapt(gap: number): void {
    if (gap > kSlowMs) this.share = Math.max(kLeast, this.share * Math.max(kStep, Math.sqrt(kSlowMs / gap)));
    this.quick = gap < kQuickMs ? this.quick + 1 : 0;
    if (this.quick < kQuickPictures) return;
    this.quick = 0;
    this.share = Math.min(1, this.share / kStep);
  }
}
