// The number of pixels to draw: fewer while the machine is too slow to draw all of them as fast as the world
// moves, and all of them once it stands. Another number costs the browser a new canvas, for which the page
// waits until the pictures before it are drawn: as long as some pictures take. So there are few steps between
// them, it is slow to try more after that has failed, and a short rest is not standing. Pure: asked once for
// each frame of the display.

const kSlowMs = 45; // between two pictures
const kQuickMs = 20;
const kQuickPictures = 40; // as many in a row before it tries more pixels, at first
const kMostPatience = 1280; // and at last
const kProbation = 120; // pictures: more pixels that are too many within them were tried too early
const kShares = [1, 0.7, 0.5, 0.4];
const kStandsMs = 2000; // a rest between two movements of a robot is shorter

export class Resolution {
  private step = 0; // in kShares, while things move
  private drawn = 1; // the share of the last picture
  private last = NaN; // ms; when it was drawn
  private follows = false; // the frame before had a picture, too
  private quick = 0;
  private patience = kQuickPictures;
  private sinceMore = Infinity; // pictures since it tried more pixels

  // The share of the pixels to draw at `now` (ms); null: draw no picture. `wanted`: something moved.
  frame(now: number, wanted: boolean): number | null {
    if (wanted && this.follows) this.adapt(now - this.last);
    this.follows = wanted;
    const stands = !wanted && this.drawn < 1 && now - this.last > kStandsMs;
    if (!wanted && !stands) return null;
    this.last = now;
    this.drawn = stands ? 1 : kShares[this.step]!;
    return this.drawn;
  }

  private adapt(gap: number): void {
    this.sinceMore += 1;
    if (gap > kSlowMs) this.useFewer(gap);
    this.quick = gap < kQuickMs ? this.quick + 1 : 0;
    if (this.quick < this.patience || this.step === 0) return;
    this.quick = 0;
    this.sinceMore = 0;
    this.step -= 1;
  }

  // Twice the time asks for half the pixels: the square root of a half on each side. It goes one step at a
  // time, because one picture may be late by chance.
  private useFewer(gap: number): void {
    if (kShares[this.step]! * Math.sqrt(kSlowMs / gap) > (kShares[this.step + 1] ?? 0) * 1.15) return;
    if (this.sinceMore < kProbation) this.patience = Math.min(kMostPatience, 2 * this.patience);
    this.step = Math.min(kShares.length - 1, this.step + 1);
  }
}
