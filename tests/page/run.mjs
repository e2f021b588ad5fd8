// Runs the tests of this folder. Without a browser it exits with 77, which ctest shows as skipped.
import { spawnSync } from "node:child_process";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { browserPath } from "./programs.mjs";

const kSkipped = 77;
if (!browserPath) {
  console.log("skipped: no Chromium (Debian's package chromium, or VISUM_CHROMIUM=PATH)");
  process.exit(kSkipped);
}
const file = join(dirname(fileURLToPath(import.meta.url)), "all.mjs");
process.exit(spawnSync(process.execPath, ["--test", file], { stdio: "inherit" }).status ?? 1);
