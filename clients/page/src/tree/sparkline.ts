// The last seconds of a value, drawn as small as a word.
import { cssColor } from "../ui/palette";
import { fit } from "../ui/range";

const kPoints = 60;
const kWidth = 56;
const kHeight = 18;

export class Sparkline {
  readonly canvas = document.createElement("canvas");
  private readonly values: number[] = [];
  private drawn = "";

  // `least`: a smaller change is noise, and is not blown up.
  constructor(private readonly least: number) {
    this.canvas.className = "spark";
    this.canvas.width = 2 * kWidth;
    this.canvas.height = 2 * kHeight;
    this.canvas.setAttribute("aria-hidden", "true");
  }

  add(value: number): void {
    this.values.push(value);
    if (this.values.length > kPoints) this.values.shift();
  }

  draw(): void {
    const known = this.values.filter((value) => !Number.isNaN(value));
    const range = fit(known, 0, this.least);
    const still = known.length < 2 || !range;
    const { low, high } = range ?? { low: 0, high: 1 };
    const key = still ? "still" : `${low} ${high} ${known.at(-1)} ${known[0]} ${known.length}`;
    if (key === this.drawn) return;
    this.drawn = key;
    const context = this.canvas.getContext("2d");
    if (!context) return;
    const { width, height } = this.canvas;
    context.clearRect(0, 0, width, height);
    context.strokeStyle = cssColor("--accent");
    context.lineWidth = 2;
    context.beginPath();
    if (still) context.moveTo(0, height / 2), context.lineTo(width, height / 2);
    else known.forEach((value, i) => {
      const x = (i / (kPoints - 1)) * width;
      const y = height - 3 - ((value - low) / (high - low)) * (height - 6);
      if (i === 0) context.moveTo(x, y);
      else context.lineTo(x, y);
    });
    context.globalAlpha = still ? 0.35 : 1;
    context.stroke();
    context.globalAlpha = 1;
  }
}
