// Reads JSON that nobody can be sure of. Each function throws a BadFileError that says what is wrong, and
// where (`at`). Pure.

export class BadFileError extends Error {}

export function asObject(value: unknown, at: string): Record<string, unknown> {
  if (typeof value !== "object" || value === null || Array.isArray(value)) throw new BadFileError(`${at}: must be a map`);
  return value as Record<string, unknown>;
}

export function asList(value: unknown, at: string, most = Infinity): unknown[] {
  if (!Array.isArray(value)) throw new BadFileError(`${at}: must be a list`);
  if (value.length > most) throw new BadFileError(`${at}: more than ${most}`);
  return value;
}

export function asText(value: unknown, at: string): string {
  if (typeof value !== "string") throw new BadFileError(`${at}: must be a text`);
  return value;
}

export function asNumber(value: unknown, at: string): number {
  if (typeof value !== "number" || !Number.isFinite(value)) throw new BadFileError(`${at}: must be a number`);
  return value;
}

export function asWhole(value: unknown, least: number, most: number, at: string): number {
  const found = asNumber(value, at);
  if (!Number.isInteger(found) || found < least || found > most) throw new BadFileError(`${at}: must be a whole number from ${least} to ${most}`);
  return found;
}

// The root of a file, a map.
export function parseObject(text: string): Record<string, unknown> {
  let root: unknown;
  try {
    root = JSON.parse(text);
  } catch (error) {
    throw new BadFileError(`the file is not JSON: ${(error as Error).message}`);
  }
  return asObject(root, "the file");
}
