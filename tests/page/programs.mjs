// The real programs, for the tests of this folder: visumd on free ports, and Chromium with the page that it serves.
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
  // `options`: of visumd; a scene first, where it is not the arm's; "--hold" where time is to stand at first.
  static async start(...options) {
    const daemon = new Daemon();
    await daemon.serve(...options);
    return daemon;
  }
  async serve(...options) {
    const scene = options[0]?.endsWith(".yaml") ? options.shift() : join(source, "models/scenes/amtec_arm.yaml");
    const own = ["--json", "-v", "0", "--iterations", kMostTicks];
    if (!options.includes("--hold")) own.push("--run");
    if (!options.includes("--port")) own.push("--port", "0");
    await this.spawn("visumd", [scene, ...own, ...options.filter((word) => word !== "--hold")]);
  }
  // Any server program; done when it is ready.
  async spawn(program, words) {
    this.process = spawn(join(bin, program), words, { stdio: ["ignore", "pipe", "inherit"] });
    const died = once(this.process, "exit").then(([code]) => Promise.reject(new Error(`${program} ended with ${code} before it was ready`)));
    const [line] = await Promise.race([once(createInterface({ input: this.process.stdout }), "line"), died]);
    died.catch(() => undefined); // later, it may end
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

// Two virtual arms, each in a world of its own, behind one part: the mirror serves the page.
export class MirroredPair extends Daemon {
  static async start() {
    const pair = new MirroredPair();
    pair.arms = [await Daemon.start("--http", "off"), await Daemon.start("--http", "off")];
    const [primary, shadow] = pair.arms.map(({ port }) => `127.0.0.1:${port}`);
    await pair.spawn("visum-mirror", ["--primary", primary, "--shadow", shadow, "--port", "0", "--json", "-v", "0", "--iterations", kMostTicks]);
    return pair;
  }
  // The shadow comes along no more: its time stands.
  holdBack() {
    execFileSync(join(bin, "visum"), ["pause", "--connect", `127.0.0.1:${this.arms[1].port}`]);
  }
  async stop() {
    await super.stop();
    for (const arm of this.arms) await arm.stop();
  }
}

// Without a GPU: the processor draws. The sandbox is left out where root runs the tests, who may not use it.
export const launch = () =>
  chromium.launch({
    executablePath: browserPath,
    chromiumSandbox: process.getuid() !== 0,
    args: ["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist"],
  });

// A page of `daemon` that shows live data. `page.faults` gathers what no page may do: errors on the console,
// exceptions, requests to elsewhere.
export async function openPage(browser, daemon, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 720 }, ...options });
  const page = await context.newPage();
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
// Waits for what must come; the time-out is a guard against hanging for ever, not a measure.
export const until = (page, condition, argument) => page.waitForFunction(condition, argument, { timeout: kLiveMs, polling: 100 });
