// Makes the pictures of the shipped robots, on their pages: a moment of each one's scenario.
//   node tests/page/portraits.mjs [NAME...]        default: all
// It needs Debian's package webp, Chromium, and visumd and visum in VISUM_BIN. It takes some minutes. The
// world stands at its moment, so that the picture is the same on a slow machine.
import { execFileSync } from "node:child_process";
import { mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { drawn } from "./picture.mjs";
import { Daemon, bin, launch, openPage, source } from "./programs.mjs";

// scenario: [file below models/, moment in s, viewpoint of the scene]
const kPortraits = {
  cart: ["cart/cart.webp", 8, null],
  crawler: ["crawler/crawler.webp", 6, null],
  mobile_arm: ["mobile_base/mobile_arm.webp", 24, "Front"],
  mobile_base: ["mobile_base/mobile_base.webp", 9, null],
  quadruped: ["quadruped/quadruped.webp", 4, "Front"],
  six_axis_arm: ["six_axis_arm/six_axis_arm.webp", 37.5, "Front"],
  two_robots: ["cart/two_robots.webp", 12, null],
};

const folder = mkdtempSync(join(tmpdir(), "visum-portraits-"));
const browser = await launch();
try {
  for (const name of process.argv.length > 2 ? process.argv.slice(2) : Object.keys(kPortraits)) await portray(name, ...kPortraits[name]);
} finally {
  await browser.close();
  rmSync(folder, { recursive: true });
}

async function portray(name, file, moment, viewpoint) {
  const recording = join(folder, `${name}.mcap`), picture = join(folder, `${name}.png`);
  execFileSync(join(bin, "visum"), ["run", join(source, `models/scenarios/${name}.yaml`), "--record", recording], { stdio: "ignore" });
  const daemon = new Daemon();
  await daemon.spawn("visumd", ["rewind", recording, "--at", String(moment), "--port", "0", "--json", "-v", "0"]);
  const page = await openPage(browser, daemon, { viewport: { width: 1440, height: 680 } });
  if (viewpoint) await page.getByRole("combobox", { name: "Viewpoint" }).selectOption(viewpoint);
  await page.evaluate(() => new Promise((done) => setTimeout(done, 2000))); // the view travels there
  await page.evaluate(() => document.querySelectorAll(".view > :not(canvas)").forEach((part) => (part.style.display = "none")));
  await drawn(page);
  await page.locator(".view canvas").screenshot({ path: picture });
  execFileSync("cwebp", ["-quiet", "-q", "80", picture, "-o", join(source, "models", file)]);
  console.log(`models/${file}: ${page.faults.length === 0 ? "no fault" : JSON.stringify(page.faults)}`);
  await page.context().close();
  await daemon.stop();
}
