// Groups ports that stand side by side in one vector. They are written in one message, because a part may
// demand that they agree. Pure.

// The place of a port, as Port in part.ts has it. part.ts imports this file, so this file does not import
// part.ts.
interface Placed {
  readonly part: { readonly name: string };
  readonly side: string;
  readonly index: number;
}

export function neighbours<P extends Placed>(ports: readonly P[]): P[][] {
  const runs: P[][] = [];
  for (const port of [...ports].sort(inOrder)) {
    const run = runs.at(-1);
    if (run && follows(port, run.at(-1)!)) run.push(port);
    else runs.push([port]);
  }
  return runs;
}

function inOrder(a: Placed, b: Placed): number {
  return a.part.name.localeCompare(b.part.name) || a.side.localeCompare(b.side) || a.index - b.index;
}

function follows(port: Placed, before: Placed): boolean {
  return port.part === before.part && port.side === before.side && port.index === before.index + 1;
}
