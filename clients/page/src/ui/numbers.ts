// Numbers as people read them. Pure.

const kWidest = 1e6;
const kMostDecimals = 5;

export function formatValue(value: number, unit = ""): string {
  if (Number.isNaN(value)) return "–";
  if (unit === "" && Number.isInteger(value)) return String(value);
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-4 || size >= kWidest)) return value.toExponential(2).replace("-", "−");
  const digits = size >= 1000 ? 1 : size >= 100 ? 2 : size >= 10 ? 3 : 4;
  return value.toFixed(digits).replace("-", "−");
}

// A value of a range, always with the same decimals: four below the size of its half (0.0000 for ±3 rad,
// 0.00000 for some centimetres). So a value that trembles about zero stays readable. Whole numbers without a
// unit stay whole.
export function formatInRange(value: number, minimum: number, maximum: number, unit = ""): string {
  const decimals = decimalsIn(minimum, maximum);
  if (decimals === null || !(Math.abs(value) < kWidest) || (unit === "" && Number.isInteger(value))) return formatValue(value, unit);
  return value.toFixed(decimals).replace(/^-(?=[0.]*$)/, "").replace("-", "−");
}

// The text of an input field for a value of a range, without what is too small to matter: 0, 1.25, -0.0031.
export function fieldText(value: number, minimum: number, maximum: number): string {
  const decimals = decimalsIn(minimum, maximum);
  return String(Number(decimals === null ? value.toPrecision(6) : value.toFixed(decimals)) || 0);
}

function decimalsIn(minimum: number, maximum: number): number | null {
  const range = maximum - minimum;
  return range > 0 && range < kWidest ? Math.min(kMostDecimals, Math.max(0, 4 - Math.floor(Math.log10(range / 2)))) : null;
}

// An end of a range, as short as can be: 3.093, −9.4, 0.07.
export function formatEnd(value: number): string {
  return String(Number(value.toPrecision(4))).replace("-", "−");
}

interface Worded {
  values?: readonly { number: bigint; name: string }[];
  bits?: readonly { number: bigint; name: string }[];
}

// A port's value in words: the name of the value, or of the bits that are set. Empty where the port has none.
export function inWords(port: Worded, value: number): string {
  if (!Number.isSafeInteger(value)) return "";
  const number = BigInt(value);
  const named = port.values?.find((one) => one.number === number);
  if (named) return named.name;
  if (value < 0) return "";
  return (port.bits ?? []).filter((bit) => (number >> bit.number) & 1n).map((bit) => bit.name).join(" ");
}

// The text of a port's value.
export function formatOf(port: ({ minimum: number; maximum: number; unit: string } & Worded) | undefined, value: number): string {
  if (!port) return formatValue(value);
  return inWords(port, value) || formatInRange(value, port.minimum, port.maximum, port.unit);
}

export function formatTime(seconds: number): string {
  if (!Number.isFinite(seconds)) return "–";
  const minutes = Math.floor(seconds / 60);
  const rest = (seconds - 60 * minutes).toFixed(3).padStart(6, "0");
  const hours = Math.floor(minutes / 60);
  const mm = String(minutes % 60).padStart(2, "0");
  return hours > 0 ? `${hours}:${mm}:${rest}` : `${mm}:${rest}`;
}

export function formatNs(ns: number): string {
  if (ns >= 1e9) return `${(ns / 1e9).toFixed(2)} s`;
  if (ns >= 1e6) return `${(ns / 1e6).toFixed(2)} ms`;
  return ns >= 1000 ? `${(ns / 1000).toFixed(1)} µs` : `${Math.round(ns)} ns`;
}

export function formatBytes(bytes: number): string {
  if (bytes < 1000) return `${Math.round(bytes)} B`;
  return bytes < 1e6 ? `${(bytes / 1000).toFixed(1)} kB` : `${(bytes / 1e6).toFixed(2)} MB`;
}

// Radians in degrees as well, for a tooltip. Empty for other units.
export function inDegrees(value: number, unit: string): string {
  if (!unit.startsWith("rad") || Number.isNaN(value)) return "";
  return `${((value * 180) / Math.PI).toFixed(2)} °${unit.slice(3)}`;
}

// The place of `value` between the limits, 0 to 1.
export function share(value: number, minimum: number, maximum: number): number {
  if (!(maximum > minimum)) return 0;
  return Math.min(1, Math.max(0, (value - minimum) / (maximum - minimum)));
}

// A step for editors: a thousandth of the range, rounded to 1, 2 or 5 times a power of ten.
export function niceStep(minimum: number, maximum: number): number {
  const raw = (maximum - minimum) / 1000;
  if (!(raw > 0) || !Number.isFinite(raw)) return 1;
  const power = 10 ** Math.floor(Math.log10(raw));
  const factor = [1, 2, 5, 10].find((candidate) => candidate * power >= raw * 0.999) ?? 10;
  return factor * power;
}
