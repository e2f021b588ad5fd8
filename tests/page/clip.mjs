// Makes the README's clip: the arm carries the box to its place while the page shows it.
//   node tests/page/clip.mjs [FILE]        default: clients/page/arm.webp
// It needs Debian's package webp, Chromium, and visumd, visum and visum-pick-and-place in VISUM_BIN. It
// takes some minutes. Time stands while a picture is taken, so the clip looks the same on a slow machine.
import { execFileSync, spawn } from "node:child_process";
import { mkdtempSync, rmSync, statSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { drawn } from "./picture.mjs";
import { Daemon, bin, launch, openPage, source, until } from "./programs.mjs";

const file = process.argv[2] ?? join(source, "clients/page/arm.webp");
// VISUM_PICTURES: keeps them there
const folder = process.env.VISUM_PICTURES ?? mkdtempSync(join(tmpdir(), "visum-clip-"));
const kTicks = 200; // ms of simulated time between two pictures
const kShownMs = 100; // twice as fast as life
const kLastMs = 2000; // the last picture stays before the clip begins again
const kMostPictures = 250; // the arm needs 113

// Paused under lockstep, so that the world moves by the steps of the page alone, and the controller is never
// late.
const daemon = await Daemon.start("--clock", "lockstep");
execFileSync(join(bin, "visum"), ["pause", "--connect", `127.0.0.1:${daemon.port}`]);
const browser = await launch();
let controller;
try {
  const page = await openPage(browser, daemon, { viewport: { width: 1000, height: 560 } });
  // Closes it: the view gets its place
  await page.getByRole("button", { name: "Panel", exact: true }).click();
  controller = spawn(join(bin, "visum-pick-and-place"), ["--connect", `127.0.0.1:${daemon.port}`], { stdio: ["ignore", "ignore", "inherit"] });
  const pictures = await picturesOf(page);
  const last = pictures.pop();
  execFileSync("img2webp", ["-loop", "0", "-lossy", "-q", "50", "-m", "6", "-d", String(kShownMs), ...pictures, "-d", String(kLastMs), last, "-o", file], { stdio: "ignore" });
  console.log(`${file}: ${pictures.length + 1} pictures, ${Math.round(statSync(file).size / 1000)} kB, ${page.faults.length === 0 ? "no fault" : JSON.stringify(page.faults)}`);
} finally {
  if (controller?.exitCode === null) controller.kill();
  await browser.close();
  await daemon.stop();
  if (!process.env.VISUM_PICTURES) rmSync(folder, { recursive: true });
}

// One picture after each step of time, until the controller has ended.
async function picturesOf(page) {
  await until(page, () => document.querySelector(".part .holder").textContent !== "free");
  await page.getByRole("spinbutton", { name: "Number of ticks" }).fill(String(kTicks));
  const files = [];
  while (controller.exitCode === null && files.length < kMostPictures) {
    const next = (await page.evaluate(() => visum.simTime())) + kTicks / 1000;
    await page.getByRole("button", { name: "ticks", exact: true }).click();
    await until(page, (time) => visum.simTime() > time - 1e-9, next);
    await drawn(page);
    files.push(join(folder, `${String(files.length).padStart(3, "0")}.png`));
    await page.screenshot({ path: files.at(-1) });
  }
  if (controller.exitCode !== 0) throw new Error(`the arm is not done after ${files.length} pictures (exit code ${controller.exitCode})`);
  return files;
}
