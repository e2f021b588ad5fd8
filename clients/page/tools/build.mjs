// Builds the page into a folder: messages, type check, bundle, and a .gz beside each file that shrinks by it.
//   node tools/build.mjs [FOLDER]        default: dist
import { execFileSync } from "node:child_process";
import { readFileSync, readdirSync, statSync, writeFileSync } from "node:fs";
import { dirname, join, resolve } from "node:path";
import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";
import { build } from "vite";

const page = dirname(dirname(fileURLToPath(import.meta.url)));
const out = resolve(process.argv[2] ?? join(page, "dist"));
const kFirstLoadLimit = 500_000; // bytes, compressed

const run = (command, ...args) => execFileSync(process.execPath, [join(page, command), ...args], { cwd: page, stdio: "inherit" });
run("tools/generate.mjs");
run("node_modules/typescript/bin/tsc", "--noEmit");
await build({ root: page, build: { outDir: out, emptyOutDir: true }, logLevel: "warn" });

function* filesBelow(folder) {
  for (const name of readdirSync(folder)) {
    const path = join(folder, name);
    if (statSync(path).isDirectory()) yield* filesBelow(path);
    else yield path;
  }
}

let total = 0;
for (const path of [...filesBelow(out)]) {
  const plain = readFileSync(path);
  const compressed = gzipSync(plain, { level: 9 });
  const shrinks = compressed.length < 0.9 * plain.length;
  if (shrinks) writeFileSync(`${path}.gz`, compressed);
  total += shrinks ? compressed.length : plain.length;
}
console.log(`page: ${total} bytes compressed, in ${out}`);
if (total > kFirstLoadLimit) {
  console.error(`page: more than ${kFirstLoadLimit} bytes compressed`);
  process.exit(1);
}
