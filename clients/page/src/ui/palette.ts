// Colours of traces, by Okabe and Ito: the colour-blind can tell them apart. The yellow is darker, to be
// visible on white.

const kLight = ["#0072b2", "#d55e00", "#009e73", "#b0499a", "#a07d00", "#3a9bd9", "#5b5b5b", "#8c2d04"];
const kDark = ["#56b4e9", "#ff9d4d", "#35d0a5", "#e59ac9", "#f0e442", "#8fc7ff", "#c8c8c8", "#ff7f50"];
const kDashes: number[][] = [[], [7, 4], [2, 3], [9, 3, 2, 3]];

let scheme: MediaQueryList | null = null;
const isDark = (): boolean => (scheme ??= matchMedia("(prefers-color-scheme: dark)")).matches;

export function traceColor(index: number): string {
  const colors = isDark() ? kDark : kLight;
  return colors[index % colors.length]!;
}

// After eight colours the lines are dashed.
export function traceDash(index: number): number[] {
  return kDashes[Math.floor(index / kLight.length) % kDashes.length]!;
}

// Asking the document for a colour costs as much as drawing a line, and drawings ask many times a second.
const known = { dark: false, colors: new Map<string, string>() };

export function cssColor(name: string): string {
  if (known.dark !== isDark()) {
    known.dark = isDark();
    known.colors.clear();
  }
  const color = known.colors.get(name) ?? getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  known.colors.set(name, color);
  return color;
}
