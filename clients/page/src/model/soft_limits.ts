// The limits that a drive's own software keeps (parameters "Soft Limit Minimum 1", ...), by the name of the
// input that they bound. A command beyond them trips the drive, though the port takes it. Pure.
import type { ParameterDescription, PartDescription } from "../link/messages";
import { kDesired } from "./desired";

export interface Limits {
  minimum: number;
  maximum: number;
}

interface DriveLimits extends Limits {
  unit: string;
}

// Drives and desired positions of one unit have the same order. One drive with several positions moves them
// alike, and its limits count for their sum. An input whose drive is not clear has no limits here.
export function softLimits({ controllerInputs, parameters }: Pick<PartDescription, "controllerInputs" | "parameters">): Map<string, Limits> {
  const drives = limitsOfDrives(parameters);
  const limits = new Map<string, Limits>();
  for (const unit of new Set(drives.map((drive) => drive.unit))) {
    const own = drives.filter((drive) => drive.unit === unit);
    const names = controllerInputs.filter((port) => kDesired.test(port.group) && port.unit === unit).map(({ name }) => name);
    if (own.length !== names.length && own.length !== 1) continue;
    names.forEach((name, i) => {
      const { minimum, maximum } = own[own.length === 1 ? 0 : i]!;
      const shared = own.length === 1 ? names.length : 1;
      limits.set(name, { minimum: minimum / shared, maximum: maximum / shared });
    });
  }
  return limits;
}

function limitsOfDrives(parameters: readonly ParameterDescription[]): DriveLimits[] {
  const limits = new Map<string, DriveLimits>();
  for (const { name, unit, value } of parameters) {
    const [, end, number] = /^Soft Limit (Minimum|Maximum) (\d+)$/.exec(name) ?? [];
    if (!end || !number || value?.value.case !== "number") continue;
    limits.set(number, { ...(limits.get(number) ?? { unit, minimum: -Infinity, maximum: Infinity }), [end.toLowerCase()]: value.value.value });
  }
  return [...limits.values()];
}
