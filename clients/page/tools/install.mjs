// Fetches the packages that package-lock.json fixes into node_modules (npm ci); does nothing, and needs no
// network, where they stand there already.
import { spawnSync } from "node:child_process";
import { copyFileSync, existsSync, readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";

const kOldestNode = 18;
const page = dirname(dirname(fileURLToPath(import.meta.url)));
const lock = join(page, "package-lock.json");
const installed = join(page, "node_modules/.installed-lock.json"); // a copy of the lock that was installed

function fail(text) {
  console.error(`page: ${text}`);
  process.exit(1);
}

if (Number(process.versions.node.split(".")[0]) < kOldestNode)
  fail(`node ${process.versions.node} is too old, ${kOldestNode} is needed; -D VISUM_PAGE=OFF builds without the page`);
if (existsSync(installed) && readFileSync(installed).equals(readFileSync(lock))) process.exit(0);

const npm = process.argv[2] ?? "npm";
const result = spawnSync(npm, ["ci", "--ignore-scripts", "--prefer-offline", "--no-audit", "--no-fund", "--loglevel=error"], { cwd: page, stdio: "inherit" });
if (result.error) fail(`cannot run ${npm}: ${result.error.message}`);
if (result.status !== 0)
  fail("npm could not fetch the packages that clients/page/package-lock.json names (its own words stand above). " +
    "Is the registry within reach? -D VISUM_PAGE=OFF builds without the page.");
copyFileSync(lock, installed);
