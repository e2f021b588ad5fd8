// Makes the README's clip: the arm carries the box to its place while the page shows it.
//   node tests/page/clip.mjs [FILE]        default: clients/page/arm.webp
// It needs Debian's package webp (img2webp), Chromium, and visumd and visum-pick-and-place of the build in VISUM_BIN.
// Time stands while a picture is taken, so that the clip looks the same on a slow machine.
import { execFileSync, spawn } from "node:child_process";
import { mkdtempSync, rmSync, statSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { drawn } from "./picture.mjs";
import { Daemon, bin, launch, openPage, source, until } from "./programs.mjs";

const file = process.argv[2] ?? join(source, "clients/page/arm.webp");
const kTicks = 160; // ms of simulated time between two pictures
const kShownMs = 80; // twice as fast as life
const kLastMs = 2000; // the last picture stays before the clip begins again
const kMostPictures = 300;
const kPlotted = ["Desired Angle 2", "Actual Angle 2"];

const folder = mkdtempSync(join(tmpdir(), "visum-clip-"));
const browser = await launch();
const daemon = await Daemon.start();
execFileSync(join(bin, "visum"), ["pause", "--connect", `127.0.0.1:${daemon.port}`]);
const page = await openPage(browser, daemon, { viewport: { width: 1120, height: 630 } });
for (const port of kPlotted) await page.getByRole("button", { name: `Plot ${port}`, exact: true }).click();
await page.getByRole("spinbutton", { name: "Number of ticks" }).fill(String(kTicks));

const controller = spawn(join(bin, "visum-pick-and-place"), ["--connect", `127.0.0.1:${daemon.port}`], { stdio: ["ignore", "inherit", "inherit"] });
const ended = new Promise((done) => controller.on("exit", done));
let code; // of the controller, once it has ended
ended.then((exitCode) => (code = exitCode));
await until(page, () => document.querySelector(".part .holder").textContent !== "free");

const pictures = [];
while (code === undefined && pictures.length < kMostPictures) {
  const next = (await page.evaluate(() => visum.simTime())) + kTicks / 1000;
  await page.getByRole("button", { name: "ticks", exact: true }).click();
  await until(page, (time) => visum.simTime() > time - 1e-9, next);
  await drawn(page);
  pictures.push(join(folder, `${String(pictures.length).padStart(3, "0")}.png`));
  await page.screenshot({ path: pictures.at(-1) });
}
if (code !== 0) throw new Error(`visum-pick-and-place ended with ${code} after ${pictures.length} pictures`);

const last = pictures.pop();
execFileSync("img2webp", ["-loop", "0", "-lossy", "-q", "55", "-m", "4", "-d", String(kShownMs), ...pictures, "-d", String(kLastMs), last, "-o", file], { stdio: "ignore" });
console.log(`${file}: ${pictures.length + 1} pictures, ${Math.round(statSync(file).size / 1000)} kB, ${page.faults.length === 0 ? "no fault" : JSON.stringify(page.faults)}`);
if (!process.env.VISUM_KEEP) rmSync(folder, { recursive: true });
else console.log(folder);
await browser.close();
await daemon.stop();
