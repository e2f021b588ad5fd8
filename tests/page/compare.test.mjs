// Two recordings on the page: B's bodies are ghosts, its ports dashed lines, and where they part is marked.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { axeFindings, body, button, drawn, flat, look, overlay, pageTest, until } from "./harness.mjs";
import { linkPositions, readArm } from "./kinematics.mjs";
import { around } from "./picture.mjs";
import { bin, Daemon, source } from "./programs.mjs";

// A value that is set between two ticks acts in the later one.
const kTicksA = 2500, kTicksB = 2000, kParting = 1201;
const kGhost = (r, g, b) => g > 1.15 * r && g > 1.05 * b; // whatever is behind it

const visum = (...words) => execFileSync(join(bin, "visum"), words, { encoding: "utf8", maxBuffer: 1 << 28 });

// Two runs of the arm: B turns joint 3 as well, from 1.2 s on, and ends sooner.
class TwoRuns extends Daemon {
  static async start() {
    const two = new TwoRuns();
    two.folder = mkdtempSync(join(tmpdir(), "visum-two-"));
    two.a = two.record("first.mcap", kTicksA, "");
    two.b = two.record("second.mcap", kTicksB, '  - {at_s: 1.2, set: {part: arm, port: "Desired Angle 3", value: 0.9}}\n');
    await two.spawn("visumd", ["replay", two.a, "--view", "--beside", two.b, "--http", "0", "--json"]);
    return two;
  }
  record(name, ticks, more) {
    const scenario = join(this.folder, "scenario.yaml");
    writeFileSync(scenario, `visum_scenario: 1\nname: two\nscene: ${join(source, "models/scenes/amtec_arm.yaml")}\nuntil: {at_s: ${ticks / 1000}}\ntimeline:\n` +
      `  - {at_s: 0.1, set: {part: arm, port: "Desired Angle 1", value: 0.3}}\n${more}`);
    visum("run", scenario, "--record", join(this.folder, name));
    return join(this.folder, name);
  }
  // The recorded values of ports, by tick.
  rows(file, ports) {
    const [head, ...lines] = visum("export", file, ...ports.flatMap((port) => ["--ports", `arm/${port}`])).trim().split("\n").map((line) => line.split(","));
    const columns = ports.map((port) => head.findIndex((name) => name.includes(port)));
    assert.ok(columns.every((column) => column > 0), `${ports} in ${head}`);
    return lines.map((line) => columns.map((column) => Number(line[column])));
  }
  async stop() {
    await super.stop();
    rmSync(this.folder, { recursive: true });
  }
}

const isNear = (value, expected) => Math.abs(value - expected) < 1e-6; // a plot keeps single precision
const slider = (page) => page.getByRole("slider", { name: "Time of the recording" });
const sign = (page) => page.locator(".ghost-sign:visible").textContent();
const list = (page) => page.locator(".differing > summary");
const words = (page) => page.locator(".timeline-words").textContent();
const compared = (page) => until(page, () => /^They part/.test(document.querySelector(".timeline-words").textContent));

// Resolves when both worlds stand there.
async function dragTo(page, position) {
  await slider(page).fill(String(position));
  await standsAt(page, position);
}
const standsAt = (page, position) => until(page, (at) => [visum.simTime(), visum.shownTime()].every((time) => Math.abs(time - at / 1000) < 1e-9) && visum.besidePosition() === at, position);

async function csv(page) {
  const [download] = await Promise.all([page.waitForEvent("download"), button(page, "Export as CSV").click()]);
  const [head, ...lines] = readFileSync(await download.path(), "utf8").trim().split(/\r?\n/).map((line) => line.split(","));
  return { head, rows: lines.map((line) => line.map((cell) => (cell === "" ? null : Number(cell)))) };
}

pageTest("two recordings are shown on one ruler, with the first difference marked", async (page, claim, two) => {
  await compared(page);

  await claim("they part where `visum compare` says so, at the same port, with the same values", async () => {
    assert.equal(await page.locator(".timeline-pair").textContent(), "A first.mcap · B second.mcap (ghost, dashed)");
    assert.match(await words(page), /^They part at tick 1,201\. .*arm, Desired Angle 3: A 0, B 0\.9.* A has 2,500 ticks, B 2,000\.$/);
    const told = JSON.parse(compareJson(two));
    assert.equal(told.first_tick, kParting);
    assert.equal(await list(page).textContent(), `Differences (${told.ports.length})`);
    await list(page).click();
    const listed = await page.locator(".differences tbody tr").evaluateAll((rows) => rows.map((row) => [row.cells[0].textContent, row.cells[1].textContent.replaceAll(",", "")]));
    const expected = told.ports.map(({ port, tick }) => [port, String(tick)]).sort((a, b) => a[1] - b[1]).slice(0, listed.length);
    assert.ok(listed.length > 1);
    assert.deepEqual(listed.map(([, tick]) => tick), expected.map(([, tick]) => tick), "those that part first");
    for (const row of listed) assert.ok(told.ports.some(({ port, tick }) => port === row[0] && String(tick) === row[1]), row.join());
    await page.keyboard.press("Escape");
  });

  await claim("a click on its mark leads there", async () => {
    const mark = page.locator(".parting-mark.first");
    assert.match(await mark.getAttribute("title"), /tick 1,201.*Desired Angle 3/);
    const [track, box] = [await slider(page).boundingBox(), await mark.boundingBox()];
    const expected = track.x + 8 + (kParting / kTicksA) * (track.width - 16);
    assert.ok(Math.abs(box.x + box.width / 2 - expected) < 2, JSON.stringify([track, box, expected]));
    await mark.click();
    await standsAt(page, kParting);
    await dragTo(page, 300);
    await button(page, "Go there").click();
    await standsAt(page, kParting);
  });

  await claim("before that there is no ghost, as all bodies are at the same places", async () => {
    await dragTo(page, kParting - 1);
    assert.match(await sign(page), /^Ghost: B, second\.mcap: all bodies are where they are in A$/);
    assert.equal(await page.evaluate(() => visum.projectGhost("arm/link_7")), null);
  });

  await claim("after it B's bodies are ghosts, where B's angles put them", async () => {
    await look(page, "Above");
    const joints = [1, 2, 3, 4, 5, 6, 7];
    const angles = two.rows(two.b, joints.map((i) => `Actual Angle ${i}`));
    for (const position of [1900, 1500]) {
      await dragTo(page, position);
      await drawn(page);
      const at = Object.fromEntries(joints.map((i) => [`joint_${i}`, angles[position - 1][i - 1]]));
      const hand = linkPositions(readArm(), at).get("link_7");
      const [ghost, expected, own] = [await page.evaluate(() => visum.projectGhost("arm/link_7")), await body(page, "floor", hand), await body(page, "arm/link_7")];
      assert.ok(Math.hypot(ghost.x - expected.x, ghost.y - expected.y) < 2, JSON.stringify([position, ghost, expected]));
      assert.ok(Math.hypot(ghost.x - own.x, ghost.y - own.y) > 5, JSON.stringify([position, ghost, own]));
    }
    await dragTo(page, 1900);
    await drawn(page);
    assert.match(await sign(page), /^Ghost: B, second\.mcap: arm\/\S+ \d+\.\d mm, .* more$/);
    const ghost = await page.evaluate(() => visum.projectGhost("arm/link_7"));
    assert.ok((await around(page, ghost, 8, kGhost)).count > 20, "it is to be seen");
    await overlay(page, "The second recording", false);
    assert.ok((await around(page, ghost, 8, kGhost)).count < 5, "and goes with its overlay");
    await overlay(page, "The second recording", true);
  });

  await claim("where B is over, it stands at its end", async () => {
    await dragTo(page, kTicksA);
    assert.match(await sign(page), /^Ghost: B, second\.mcap, which has ended: /);
  });
}, { serve: () => TwoRuns.start() });

function compareJson(two) {
  try {
    return visum("compare", two.a, two.b, "--json");
  } catch (error) {
    assert.equal(error.status, 5, error.message);
    return error.stdout;
  }
}

pageTest("a port that differs is plotted from both recordings", async (page, claim, two) => {
  await compared(page);
  const expected = { a: two.rows(two.a, ["Desired Angle 3"]), b: two.rows(two.b, ["Desired Angle 3"]) };
  const agrees = ({ rows }) => rows.every(([time, a, b]) => {
    const tick = Math.round(1000 * time);
    return (a === null || isNear(a, expected.a[tick - 1][0])) && (b === null || isNear(b, expected.b[tick - 1][0]));
  });

  await claim("chosen in the list, it is plotted where it parts", async () => {
    await list(page).click();
    await button(page, "arm/Desired Angle 3").click();
    await page.keyboard.press("Escape");
    await standsAt(page, kParting);
    let table = await csv(page);
    while (!isNear(table.rows.at(-1)?.[2], 0.9)) table = await csv(page); // the samples come a moment later
    assert.deepEqual(table.head, ["time [s]", '"arm Desired Angle 3 [rad]"', '"arm Desired Angle 3 · B [rad]"'].map((name) => name.replaceAll('"', "")));
    assert.equal(table.rows.length, kParting);
    assert.ok(agrees(table));
  });

  await claim("while A plays, B's line goes on beside it", async () => {
    // At A's end a late press would play it again
    await page.getByRole("combobox", { name: "Speed" }).selectOption("0.1×");
    await button(page, "Run").click();
    await until(page, (time) => visum.simTime() > time, (kParting + 300) / 1000);
    await button(page, "Pause").click();
    const lines = page.locator(".u-legend .u-series");
    assert.deepEqual((await lines.allTextContents()).slice(1).map((text) => text.split(/[:–-]/)[0].trim()), ["Desired Angle 3", "Desired Angle 3 · B"]);
    const both = ({ rows }) => rows.filter(([time, a, b]) => time > 1.25 && a === 0 && isNear(b, 0.9)).length;
    let table = await csv(page);
    while (both(table) <= 100) table = await csv(page);
    assert.ok(agrees(table));
  });

  await claim("it ends where B ends", async () => {
    await dragTo(page, kTicksA);
    let table = await csv(page);
    while (table.rows.length !== kTicksA) table = await csv(page);
    assert.ok(agrees(table));
    assert.ok(isNear(table.rows[kTicksB - 1][2], 0.9));
    assert.equal(table.rows[kTicksB][2], null);
  });
}, { serve: () => TwoRuns.start(), ...flat });

for (const colorScheme of ["light", "dark"])
  pageTest(`two recordings leave an accessibility checker nothing to find, and fit a phone, ${colorScheme}`, async (page) => {
    await compared(page);
    await list(page).click();
    assert.deepEqual(await axeFindings(page), []);
    const box = await page.locator(".differing .popover-body").boundingBox();
    assert.ok(box.x >= 0 && box.x + box.width <= 390 && box.y + box.height <= 844, JSON.stringify(box));
    assert.equal(await page.evaluate(() => document.documentElement.scrollWidth), 390);
  }, { serve: () => TwoRuns.start(), colorScheme, viewport: { width: 390, height: 844 }, ...flat });
