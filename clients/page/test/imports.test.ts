// Modules of the page, and the folders that they stand in, must not import each other in a circle: a reader
// can then understand them from the bottom up. Imports of types count as well.
import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { dirname, join, normalize } from "node:path";
import { test } from "node:test";

type Graph = Map<string, Set<string>>;

const kImport = /^(?:import|export)\b[^;]*?\bfrom "(\.[^"]+)"|^import "(\.[^"]+)"/gm;

function importsIn(folder: string): Graph {
  const files = readdirSync(folder, { recursive: true, encoding: "utf8" }).filter((name) => name.endsWith(".ts"));
  return new Map(files.map((file) => {
    const text = readFileSync(join(folder, file), "utf8");
    const targets = [...text.matchAll(kImport)].map(([, from, bare]) => normalize(join(dirname(file), (from ?? bare)!)));
    return [normalize(file).slice(0, -3), new Set(targets)];
  }));
}

function byFolder(modules: Graph): Graph {
  const folders: Graph = new Map();
  for (const [module, targets] of modules) {
    const folder = dirname(module);
    const of = folders.get(folder) ?? folders.set(folder, new Set()).get(folder)!;
    for (const target of targets) if (dirname(target) !== folder) of.add(dirname(target));
  }
  return folders;
}

// The first circle found, as its members in the order of the imports; empty if there is none.
function circleIn(graph: Graph): string[] {
  const done = new Set<string>();
  const visit = (name: string, path: string[]): string[] => {
    if (path.includes(name)) return [...path.slice(path.indexOf(name)), name];
    if (done.has(name)) return [];
    for (const target of graph.get(name) ?? []) {
      const circle = visit(target, [...path, name]);
      if (circle.length > 0) return circle;
    }
    done.add(name);
    return [];
  };
  for (const name of graph.keys()) {
    const circle = visit(name, []);
    if (circle.length > 0) return circle;
  }
  return [];
}

test("a circle of imports is found", () => {
  const graph = new Map([["a", new Set(["b"])], ["b", new Set(["c", "d"])], ["c", new Set<string>()], ["d", new Set(["b"])]]);
  assert.deepEqual(circleIn(graph), ["b", "d", "b"]);
  graph.get("d")!.clear();
  assert.deepEqual(circleIn(graph), []);
});

test("no module and no folder of the page imports itself, directly or through others", () => {
  const modules = importsIn("src");
  assert.ok(modules.size > 50, `${modules.size} modules`);
  assert.ok(modules.get("model/part")!.has("model/neighbours"), "imports are found");
  assert.deepEqual(circleIn(modules), []);
  modules.delete("main"); // it puts all of them together
  const folders = byFolder(modules);
  folders.delete("."); // api.ts, which only main imports
  assert.deepEqual(circleIn(folders), []);
});
