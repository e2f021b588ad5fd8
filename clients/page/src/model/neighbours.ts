// Ports that stand side by side in one vector: they are written in one message, because a part may demand that they agree. Pure.
import type { Port } from "./part";

export function neighbours(ports: readonly Port[]): Port[][] {
  const runs: Port[][] = [];
  for (const port of [...ports].sort(inOrder)) {
    const run = runs.at(-1);
    if (run && follows(port, run.at(-1)!)) run.push(port);
    else runs.push([port]);
  }
  return runs;
}

function inOrder(a: Port, b: Port): number {
  return a.part.name.localeCompare(b.part.name) || a.side.localeCompare(b.side) || a.index - b.index;
}

function follows(port: Port, before: Port): boolean {
  return port.part === before.part && port.side === before.side && port.index === before.index + 1;
}
