// How many pixels to draw: fewer while the machine is too slow to draw them all as fast as the world moves, and all of
// them again once it stands. Pure: asked once for each frame of the display.

const kSlowMs = 45; // between two pictures
const kQuickMs = 20;
const kQuickPictures = 40; // so many in a row before it dares more
const kLeast = 0.4;
const kStep = 0.7;
const kStandsMs = 400;

export class Resolution {
  private share = 1; // of the pixels of a length, while things move
  private drawn = 1; // of the last picture
  private last = NaN; // when it was drawn, ms
  private follows = false; // the frame before had a picture, too
  private quick = 0;

  // Which share of the pixels to draw at `now`, ms; null: no picture. `wanted`: something moved.
  frame(now: number, wanted: boolean): number | null {
    if (wanted && this.follows) this.adapt(now - this.last);
    this.follows = wanted;
    const stands = !wanted && this.drawn < 1 && now - this.last > kStandsMs;
    if (!wanted && !stands) return null;
    this.last = now;
    this.drawn = stands ? 1 : this.share;
    return this.drawn;
  }

  // Twice the time wants half of the pixels, the root of that in each length; not at once, for one may be late by chance.
  private adapt(gap: number): void {
    if (gap > kSlowMs) this.share = Math.max(kLeast, this.share * Math.max(kStep, Math.sqrt(kSlowMs / gap)));
    this.quick = gap < kQuickMs ? this.quick + 1 : 0;
    if (this.quick < kQuickPictures) return;
    this.quick = 0;
    this.share = Math.min(1, this.share / kStep);
  }
}
