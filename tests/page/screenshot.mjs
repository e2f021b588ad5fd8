// Makes the README's picture of the page: the arm after a jog, its ports, a panel and a plot.
//   node tests/page/screenshot.mjs [FILE]        default: clients/page/page.png
import { join } from "node:path";
import { drawn } from "./picture.mjs";
import { Daemon, launch, openPage, source, until } from "./programs.mjs";

const file = process.argv[2] ?? join(source, "clients/page/page.png");
const kMove = { "Desired Angle 1": -0.35, "Desired Angle 2": 0.35, "Desired Angle 4": 1.3, "Desired Angle 6": 1.1 };

const browser = await launch();
const daemon = await Daemon.start("--hold"); // while the browser starts, no tick can be late
const page = await openPage(browser, daemon);
// Slower than life, so that a busy machine misses fewer ticks of the plot. Make the picture on an idle
// machine.
const speed = (name) => page.getByRole("combobox", { name: "Speed" }).selectOption(name);
await speed("0.1×");
await page.getByRole("button", { name: "Run", exact: true }).click();
// Jogs the arm, and pauses once it stands: a world that stands is drawn with every pixel, on any machine.
await page.evaluate(async (move) => {
  for (const port of ["Desired Angle 2", "Actual Angle 2"]) document.querySelector(`[aria-label="Plot ${port}"]`).click();
  await visum.acquire("arm");
  for (const [port, angle] of Object.entries(move)) await visum.write("arm", port, angle);
  const isThere = () => Object.entries(move).every(([port, angle]) => Math.abs(visum.read("arm", port.replace("Desired", "Actual")) - angle) < 0.002);
  while (!isThere()) await new Promise((done) => setTimeout(done, 20));
  document.querySelector('[aria-label="Pause"]').click();
}, kMove);
await until(page, () => document.querySelector('[aria-label="Run"]'));
await speed("1×");
await drawn(page);
await drawn(page); // the plot, and samples that came late, too
await page.screenshot({ path: file });
console.log(`${file}: ${page.faults.length === 0 ? "no fault" : JSON.stringify(page.faults)}`);
await browser.close();
await daemon.stop();
