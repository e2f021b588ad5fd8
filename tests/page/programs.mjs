// Starts the real programs for the tests of this folder: visumd on free ports, and Chromium with the page
// that it serves.
import { execFileSync, spawn } from "node:child_process";
import { once } from "node:events";
import { existsSync } from "node:fs";
import { createRequire } from "node:module";
import { dirname, join } from "node:path";
import { createInterface } from "node:readline";
import { fileURLToPath } from "node:url";

export const source = join(dirname(fileURLToPath(import.meta.url)), "../..");
export const bin = process.env.VISUM_BIN ?? join(source, "build/dev/bin");
export const require = createRequire(join(source, "clients/page/package.json")); // what the page's lock fixes
const { chromium } = require("playwright-core");

export const browserPath = [process.env.VISUM_CHROMIUM, "/usr/bin/chromium", "/usr/bin/google-chrome"].find((path) => path && existsSync(path));
const kMostTicks = "600000"; // a daemon whose test died ends by itself
const kLiveMs = 120_000; // a guard against hanging for ever, not a measure

export class Daemon {
  // `options` are visumd's. A scene other than the arm's comes first; "--hold" begins with time paused.
  static async start(...options) {
    const daemon = new Daemon();
    await daemon.serve(...options);
    return daemon;
  }
  async serve(...options) {
    const scene = options[0]?.endsWith(".yaml") ? options.shift() : join(source, "models/scenes/amtec_arm.yaml");
    // On a busy machine the sessions' thread may wait longer for its turn than a robot's part may run on.
    const own = ["--json", "--iterations", kMostTicks, "--session-silence-ms", "0", "--command-age-ms", "0"];
    if (!options.includes("-v")) own.push("-v", "0");
    if (!options.includes("--hold")) own.push("--run");
    if (!options.includes("--port")) own.push("--port", "0");
    await this.spawn("visumd", [scene, ...own, ...options.filter((word) => word !== "--hold")]);
  }
  // Starts any server program, and resolves when it is ready. What it logs goes to our own stderr and to
  // `log`.
  async spawn(program, words) {
    this.process = spawn(join(bin, program), words, { stdio: ["ignore", "pipe", "pipe"] });
    this.log = "";
    this.process.stderr.setEncoding("utf8").on("data", (text) => {
      this.log += text;
      process.stderr.write(text);
    });
    const died = once(this.process, "exit").then(([code]) => Promise.reject(new Error(`${program} ended with ${code} before it was ready`)));
    const [line] = await Promise.race([once(createInterface({ input: this.process.stdout }), "line"), died]);
    died.catch(() => undefined); // once it is ready, its end is no error here
    Object.assign(this, JSON.parse(line)); // port, http, page, ...
  }
  get url() {
    return this.page;
  }
  async stop() {
    if (this.process.exitCode !== null) return;
    const ended = once(this.process, "exit");
    this.process.kill("SIGTERM");
    await ended;
  }
}

// Two virtual arms, each in its own world, behind one part. The mirror serves the page.
export class MirroredPair extends Daemon {
  static async start() {
    const pair = new MirroredPair();
    pair.arms = [await Daemon.start("--http", "off"), await Daemon.start("--http", "off")];
    const [primary, shadow] = pair.arms.map(({ port }) => `127.0.0.1:${port}`);
    await pair.spawn("visum-mirror", ["--primary", primary, "--shadow", shadow, "--port", "0", "--json", "-v", "0", "--iterations", kMostTicks]);
    return pair;
  }
  // Pauses the shadow's world, so that the shadow stays behind.
  holdBack() {
    execFileSync(join(bin, "visum"), ["pause", "--connect", `127.0.0.1:${this.arms[1].port}`]);
  }
  async stop() {
    await super.stop();
    for (const arm of this.arms) await arm.stop();
  }
}

// The processor draws, because test machines have no GPU. Chromium refuses to run as root with its sandbox.
export const launch = () =>
  chromium.launch({
    executablePath: browserPath,
    chromiumSandbox: process.getuid() !== 0,
    args: ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"],
  });

// Opens a page of `daemon` and waits until it shows live data. `page.faults` collects what no page may do:
// errors on the console, exceptions, requests to other hosts. `before` runs in the page before its own
// scripts.
export async function openPage(browser, daemon, { before, firstVisit = false, ...options } = {}) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 720 }, ...options });
  const page = await context.newPage();
  if (before) await page.addInitScript(before);
  if (!firstVisit) await page.addInitScript(() => localStorage.setItem("visum.hint", "1")); // src/bar/help.ts
  page.setDefaultTimeout(kLiveMs);
  page.faults = [];
  page.on("console", (message) => ["error", "warning"].includes(message.type()) && page.faults.push(message.text()));
  page.on("pageerror", (error) => page.faults.push(error.message));
  page.on("request", (request) => isOf(request.url(), daemon) || page.faults.push(`asked for ${request.url()}`));
  page.on("websocket", (socket) => isOf(socket.url(), daemon) || page.faults.push(`asked for ${socket.url()}`));
  await page.goto(daemon.url);
  await live(page);
  return page;
}

function isOf(url, daemon) {
  return url.startsWith("blob:") || new URL(url).host === new URL(daemon.url).host;
}

export const live = (page) => page.waitForFunction(() => document.documentElement.dataset.visum === "live", null, { timeout: kLiveMs, polling: 100 });
// Waits for a condition. The time-out is a guard against hanging for ever, not a measure.
export const until = (page, condition, argument) => page.waitForFunction(condition, argument, { timeout: kLiveMs, polling: 100 });
