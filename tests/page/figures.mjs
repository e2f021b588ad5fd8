// Prints the page's figures as JSON, one line for each: its size, its cost for a browser and for the daemon,
// and the findings of an accessibility checker. Nothing else should run meanwhile. It takes at most three
// minutes.
//   node tests/page/figures.mjs [SECONDS]        of each measurement; default: 10
import { readdirSync, readFileSync, statSync } from "node:fs";
import { connect, createServer } from "node:net";
import { cpus, loadavg } from "node:os";
import { dirname, join } from "node:path";
import { Daemon, bin, launch, openPage, require } from "./programs.mjs";

const seconds = Number(process.argv[2] ?? 10);
const kPages = 8;
const kLoads = 5;
const kPlotted = ["Desired Angle", "Actual Angle", "Actual Speed"].flatMap((group) => [1, 2, 3, 4, 5, 6, 7].map((i) => `${group} ${i}`)).slice(0, 20);
const kLongestMs = 175_000; // of the whole
const kStepMs = 60_000; // of each figure
// The browsers here would take the processor that the daemon has to itself where they are elsewhere.
const undisturbed = process.getuid() === 0 ? ["--realtime-priority", "10"] : [];
const daemons = [];

const wait = (s) => new Promise((done) => setTimeout(done, 1000 * s));
const tell = (name, value) => console.log(JSON.stringify({ [name]: value }));

async function startDaemon(...options) {
  const daemon = await Daemon.start(...options);
  daemons.push(daemon);
  return daemon;
}

// The bytes of the first load, as they go over the network.
function bundleBytes() {
  const folder = join(dirname(bin), "page");
  const files = readdirSync(folder, { recursive: true, encoding: "utf8" }).map((name) => join(folder, name)).filter((path) => statSync(path).isFile());
  const sent = files.filter((path) => path.endsWith(".gz") || !files.includes(`${path}.gz`));
  return sent.reduce((sum, path) => sum + statSync(path).size, 0);
}

// Measured at a daemon whose time begins when all pages are there.
async function lateness(browser, pages) {
  const daemon = await startDaemon("--hold", ...undisturbed);
  const opened = await Promise.all(Array.from({ length: pages }, () => openPage(browser, daemon)));
  if (opened[0]) await opened[0].getByRole("button", { name: "Run", exact: true }).click();
  else await resume(browser, daemon);
  await wait(seconds);
  const text = await (await fetch(`${daemon.url}metrics`)).text();
  await Promise.all(browser.contexts().map((context) => context.close()));
  await daemon.stop();
  const number = (name) => Number(text.split("\n").find((line) => line.startsWith(`${name} `))?.slice(name.length));
  const late = (quantile) => 1e6 * number(`visum_tick_lateness_seconds{quantile="${quantile}"}`);
  return { pages, ticks: number("visum_ticks"), overruns: number("visum_overruns_total"),
    late_us: { p50: late("0.5"), "p99.9": late("0.999"), max: late("1") } };
}

// Opens a page that starts time, and closes it.
async function resume(browser, daemon) {
  const page = await openPage(browser, daemon);
  await page.getByRole("button", { name: "Run", exact: true }).click();
  await page.context().close();
}

// From the start of the navigation to the first picture of live data, ms: of several loads, sorted.
async function firstPicture(browser) {
  const daemon = await startDaemon();
  const times = [];
  for (let load = 0; load < kLoads; ++load) {
    const before = () => new MutationObserver(() => {
      if (document.documentElement.dataset.visum === "live") window.liveAt ??= performance.now();
    }).observe(document, { attributes: true, subtree: true, attributeFilter: ["data-visum"] });
    const page = await openPage(browser, daemon, { before });
    times.push(Math.round(await page.evaluate(() => window.liveAt)));
    await page.context().close();
  }
  await daemon.stop();
  return times.sort((a, b) => a - b);
}

// Stands between browsers and a daemon, and counts what the daemon sends.
async function startCounter() {
  const counter = { bytes: 0, to: 0 };
  counter.server = createServer((browser) => {
    const daemon = connect(counter.to, "127.0.0.1");
    daemon.on("data", (data) => (counter.bytes += data.length));
    for (const [socket, other] of [[browser, daemon], [daemon, browser]]) socket.pipe(other).on("error", () => socket.destroy());
  });
  await new Promise((done) => counter.server.listen(0, "127.0.0.1", done));
  counter.host = `127.0.0.1:${counter.server.address().port}`;
  return counter;
}

// The arm moves to and fro, and `plotted` ports are drawn as they change.
async function browserCost(browser, plotted) {
  const counter = await startCounter();
  const daemon = await startDaemon("--http-host", counter.host);
  counter.to = daemon.http;
  const page = await openPage(browser, { url: `http://${counter.host}/` });
  await page.evaluate(async (ports) => {
    for (const port of ports) document.querySelector(`[aria-label="Plot ${port}"]`).click();
    await visum.acquire("arm");
    let side = 1;
    const turn = () => visum.write("arm", "Desired Angle 1", 0.4 * (side = -side)).catch(() => undefined);
    setInterval(turn, 1500);
    await turn();
  }, plotted);
  const cdp = await page.context().newCDPSession(page);
  let inMessages = 0;
  cdp.on("Network.webSocketFrameReceived", ({ response }) => (inMessages += Math.floor((response.payloadData.length * 3) / 4)));
  await cdp.send("Network.enable");
  await cdp.send("Performance.enable");
  await wait(2);
  const busy = async () => (await cdp.send("Performance.getMetrics")).metrics.find(({ name }) => name === "TaskDuration").value;
  const [before, start] = [await busy(), performance.now()];
  counter.bytes = inMessages = 0;
  const frames = await page.evaluate((ms) => new Promise((done) => {
    let count = 0;
    const end = performance.now() + ms;
    const frame = () => (++count, performance.now() < end ? requestAnimationFrame(frame) : done(count));
    requestAnimationFrame(frame);
  }), 1000 * seconds);
  const wall = (performance.now() - start) / 1000;
  const cost = { plotted: plotted.length, frames_per_second: frames / wall, main_thread_seconds_per_second: ((await busy()) - before) / wall,
    received_bytes_per_second: Math.round(counter.bytes / wall), bytes_in_messages_per_second: Math.round(inMessages / wall) };
  await page.context().close();
  counter.server.close();
  await daemon.stop();
  return cost;
}

async function axeFindings(browser) {
  const daemon = await startDaemon();
  const found = {};
  for (const colorScheme of ["light", "dark"]) {
    const page = await openPage(browser, daemon, { colorScheme });
    await page.evaluate(readFileSync(require.resolve("axe-core/axe.min.js"), "utf8"));
    const { violations } = await page.evaluate(() => axe.run({ resultTypes: ["violations"] }));
    found[colorScheme] = violations.map(({ id, nodes }) => `${id}: ${nodes.map(({ target }) => target).join(" ")}`);
    await page.context().close();
  }
  await daemon.stop();
  return found;
}

// Measures one figure. One that takes too long is reported as failed, and the next one begins.
async function measure(name, run) {
  let timer;
  const late = new Promise((_, refuse) => (timer = setTimeout(() => refuse(new Error(`not done after ${kStepMs / 1000} s`)), kStepMs)));
  try {
    tell(name, await Promise.race([run(), late]));
  } catch (error) {
    tell(name, { failed: error.message.split("\n")[0] });
    process.exitCode = 1;
    await Promise.all(browser.contexts().map((context) => context.close()));
  } finally {
    clearTimeout(timer);
  }
}

const guard = setTimeout(() => {
  console.error(`not done after ${kLongestMs / 1000} s: the machine is too slow for these figures`);
  for (const { process: child } of daemons) child.kill("SIGKILL");
  process.exit(1);
}, kLongestMs);
const browser = await launch();
tell("machine", { processors: `${cpus().length} × ${cpus()[0].model}`, load: loadavg()[0], drawn_by: "the processor (SwiftShader)" });
tell("bundle_bytes", bundleBytes());
await measure("first_live_picture_ms", () => firstPicture(browser));
await measure("page", () => browserCost(browser, []));
await measure("page_with_plots", () => browserCost(browser, kPlotted));
await measure("lateness_without_a_page", () => lateness(browser, 0));
await measure("lateness_with_pages", () => lateness(browser, kPages));
await measure("axe_findings", () => axeFindings(browser));
tell("load_after", loadavg()[0]);
await browser.close();
await Promise.all(daemons.map((daemon) => daemon.stop()));
clearTimeout(guard);
