// Resets the world. Others who are connected lose what they do, so the user is asked first. The state before
// is kept as a snapshot, so that the reset can be undone.
import type { Link } from "../link/link";
import { ResetScope } from "../link/messages";
import type { Clock } from "../model/clock";
import type { Parts } from "../model/parts";
import { ask } from "../ui/ask";
import { report, reportError } from "../ui/toasts";

const kTold = "The world was reset or restored"; // as the server's event tells it to all

export async function resetWorld(link: Link, clock: Clock, parts: Parts, scope = ResetScope.WORLD): Promise<void> {
  const concerned = whoElse(link.name, parts.list.value.map((part) => part.holder.value), clock.status.value?.sessions ?? 1);
  if (concerned !== "" && !(await ask(`Reset the world? ${concerned}`, "Reset the world"))) return;
  // A frozen world has no state worth coming back to
  const before = clock.status.value?.frozen ? null : await link.request({ case: "takeSnapshot", value: {} }, "snapshot").catch(() => null);
  await clock.reset(scope);
  if (!before) return;
  const undo = () => clock.restore(before.snapshot).catch(reportError);
  report(kTold, "note", { name: "Undo", run: () => void undo() });
}

// A sentence on who else would notice; empty: nobody. Pure.
export function whoElse(own: string, holders: readonly string[], sessions: number): string {
  const names = [...new Set(holders)].filter((name) => name !== "" && name !== own);
  if (names.length > 0) return `${names.map((name) => `'${name}'`).join(", ")} command${names.length === 1 ? "s" : ""} a part of it.`;
  const others = sessions - 1;
  return others > 0 ? `${others === 1 ? "Another session is" : `${others} other sessions are`} connected.` : "";
}
