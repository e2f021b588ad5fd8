// Numbers as people read them. Pure.

export function formatValue(value: number, unit = ""): string {
  if (Number.isNaN(value)) return "–";
  if (unit === "" && Number.isInteger(value)) return String(value);
  const size = Math.abs(value);
  if (size !== 0 && (size < 1e-4 || size >= 1e6)) return value.toExponential(2).replace("-", "−");
  const digits = size >= 1000 ? 1 : size >= 100 ? 2 : size >= 10 ? 3 : 4;
  return value.toFixed(digits).replace("-", "−");
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

// Radians also in degrees, for a tooltip; empty for other units.
export function inDegrees(value: number, unit: string): string {
  if (!unit.startsWith("rad") || Number.isNaN(value)) return "";
  return `${((value * 180) / Math.PI).toFixed(2)} °${unit.slice(3)}`;
}

// Where `value` stands between the limits, 0 to 1.
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
