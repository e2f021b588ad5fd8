// Makes the README's picture of the page: the arm at work, its ports, a panel and a plot.
//   node tests/page/screenshot.mjs [FILE]        default: clients/page/page.png
import { join } from "node:path";
import { Daemon, launch, openPage, source } from "./programs.mjs";

const file = process.argv[2] ?? join(source, "clients/page/page.png");
const kMove = { "Desired Angle 1": -0.35, "Desired Angle 2": 0.35, "Desired Angle 4": 1.3, "Desired Angle 6": 1.1 };

const browser = await launch();
const daemon = await Daemon.start();
const page = await openPage(browser, daemon);
await page.getByRole("button", { name: "Plot Desired Angle 2" }).click();
await page.getByRole("button", { name: "Plot Actual Angle 2" }).click();
await page.evaluate(async (move) => {
  await visum.acquire("arm");
  for (const [port, angle] of Object.entries(move)) await visum.write("arm", port, angle);
}, kMove);
await page.waitForFunction(() => visum.read("arm", "Actual Angle 2") > 0.2, null, { timeout: 60_000 });
await page.screenshot({ path: file });
console.log(`${file}: ${JSON.stringify(page.faults)}`);
await browser.close();
await daemon.stop();
