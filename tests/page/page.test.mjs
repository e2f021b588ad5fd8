// The page in a real browser, in front of a real visumd. Each test has a daemon and a page of its own.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { after, before, test } from "node:test";
import { linkPositions, readJoints } from "./kinematics.mjs";
import { colourAt, middleOf, pixels } from "./picture.mjs";
import { Daemon, launch, live, openPage, require, source } from "./programs.mjs";

let browser;
before(async () => {
  browser = await launch();
});
after(() => browser?.close());

// A test with a page, which must have done nothing wrong in the end.
function pageTest(name, run, options) {
  test(name, async () => {
    const daemon = await Daemon.start();
    try {
      const page = await openPage(browser, daemon, options);
      await run(page, daemon);
      assert.deepEqual(page.faults, []);
    } finally {
      await closePages();
      await daemon.stop();
    }
  });
}

const closePages = () => Promise.all(browser.contexts().map((context) => context.close()));
const until = (page, condition, argument) => page.waitForFunction(condition, argument, { timeout: 60_000, polling: 100 });
const drawn = (page) => page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));
const isRed = (r, g, b) => r > 120 && r > 2 * g && r > 2 * b;
const isBlue = (r, g, b) => b > 80 && b > 1.5 * g && b > 3 * r;

pageTest("loads, and names the world and what it is", async (page) => {
  assert.equal(await page.title(), "amtec_arm · Visum");
  assert.equal(await page.locator(".reality").textContent(), "Virtual");
  assert.equal((await page.evaluate(() => visum.ports())).length, 60);
});

pageTest("shows the arm where the ports say that it is", async (page) => {
  const joints = readJoints(join(source, "models/amtec_arm/amtec_arm.urdf"));
  const seen = await page.evaluate((names) => {
    const angles = Object.fromEntries(names.map((_, i) => [`joint_${i + 1}`, visum.read("arm", `Actual Angle ${i + 1}`)]));
    return { angles, bodies: visum.bodies() };
  }, [1, 2, 3, 4, 5, 6, 7]);
  for (const [link, position] of linkPositions(joints, seen.angles)) {
    const body = seen.bodies.find((name) => name === link || name.endsWith(`/${link}`));
    if (!body) continue; // the root, which the world holds
    const [shown, expected] = await page.evaluate(([name, point]) => [visum.project(name), visum.project("floor", point)], [body, position]);
    assert.ok(Math.hypot(shown.x - expected.x, shown.y - expected.y) < 1, `${body}: ${JSON.stringify([shown, expected])}`);
  }
  assert.ok(isRed(...(await colourAt(page, await page.evaluate(() => visum.project("target"))))), "the disc is red");
  assert.ok(isBlue(...(await colourAt(page, await page.evaluate(() => visum.project("box"))))), "the box is blue");
});

pageTest("a slider of the panel jogs a joint, and the world follows", async (page) => {
  await page.getByRole("button", { name: "Take control of arm" }).click();
  const before = await page.evaluate(() => visum.project("arm/link_2", [0, -0.3, 0]));
  await page.getByRole("button", { name: "Joint 1 more" }).click();
  await until(page, () => visum.read("arm", "Desired Angle 1") > 0.04);
  await until(page, () => Math.abs(visum.read("arm", "Actual Angle 1") - visum.read("arm", "Desired Angle 1")) < 0.005);
  const slider = page.getByRole("slider", { name: "Joint 1", exact: true });
  await slider.focus();
  await page.keyboard.press("Home"); // to its least value: by keyboard alone
  await until(page, () => visum.read("arm", "Actual Angle 1") < -0.05);
  const after = await page.evaluate(() => visum.project("arm/link_2", [0, -0.3, 0]));
  assert.notDeepEqual(after, before);
  await page.getByRole("button", { name: "Halt", exact: true }).click();
  await page.getByRole("button", { name: "Release", exact: true }).click();
});

pageTest("the second writer is refused, and told who holds the lease", async (page, daemon) => {
  const other = await openPage(browser, daemon);
  await other.evaluate(() => visum.acquire("arm"));
  await until(page, () => /^page /.test(document.querySelector(".part .holder").textContent));
  await assert.rejects(page.evaluate(() => visum.write("arm", "Desired Angle 1", 0.1)), /lease/);
  await assert.rejects(page.evaluate(() => visum.acquire("arm")), /holds|held|lease/);
  await other.evaluate(() => visum.release("arm"));
  await until(page, () => document.querySelector(".part .holder").textContent === "free");
});

pageTest("pauses, steps by one and by many, and goes on", async (page) => {
  await page.getByRole("button", { name: "Pause" }).click();
  const tick = page.getByRole("button", { name: "Single tick" });
  await tick.click({ trial: true }); // enabled once the pause is in force
  const shown = page.locator(".sim-time");
  const before = await shown.textContent();
  await tick.click();
  await until(page, (text) => document.querySelector(".sim-time").textContent !== text, before);
  const seconds = (text) => text.split(":").reduce((sum, part) => 60 * sum + Number(part), 0);
  assert.ok(Math.abs(seconds(await shown.textContent()) - seconds(before) - 0.001) < 1e-9);
  await page.getByRole("spinbutton", { name: "Number of ticks" }).fill("250");
  await page.getByRole("button", { name: "ticks", exact: true }).click();
  await until(page, (wanted) => document.querySelector(".sim-time").textContent.endsWith(wanted), (seconds(before) + 0.251).toFixed(3).slice(-3));
  await page.getByRole("button", { name: "Run" }).click();
  const from = await page.evaluate(() => visum.simTime());
  await until(page, (time) => visum.simTime() > time + 0.3, from);
});

pageTest("plots what happens at full rate, and exports it", async (page) => {
  await page.getByRole("button", { name: "Plot Desired Angle 1" }).click();
  await page.getByRole("button", { name: "Plot Actual Angle 1" }).click();
  const from = await page.evaluate(() => visum.simTime());
  await until(page, (time) => visum.simTime() > time + 1, from);
  const [download] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "Export as CSV" }).click()]);
  const lines = readFileSync(await download.path(), "utf8").trim().split("\n");
  assert.match(lines[0], /arm Desired Angle 1 \[rad\].*arm Actual Angle 1 \[rad\]/);
  const times = lines.slice(1).map((line) => Number(line.split(",")[0]));
  const gaps = times.slice(1).map((time, i) => time - times[i]).sort((a, b) => a - b);
  assert.ok(times.length > 500, `${times.length} lines`);
  assert.ok(Math.abs(gaps[gaps.length >> 1] - 0.001) < 1e-6, "a line a tick");
  const [picture] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "Export as PNG" }).click()]);
  assert.equal(readFileSync(await picture.path()).subarray(1, 4).toString(), "PNG");
});

pageTest("each eye sees near things further to the other side", async (page) => {
  await page.getByRole("button", { name: "Stereo" }).click();
  await page.getByRole("combobox", { name: "Stereo mode" }).selectOption("side-by-side");
  await page.keyboard.press("Escape");
  await drawn(page);
  const box = await page.locator(".view canvas").boundingBox();
  const image = await pixels(page, box);
  const half = image.width >> 1;
  const [left, right] = [middleOf(image, isRed, 0, half), middleOf(image, isRed, half, 2 * half)];
  assert.ok(left.count > 20 && right.count > 20, JSON.stringify([left, right]));
  assert.notEqual(left.x.toFixed(1), right.x.toFixed(1));
});

for (const colorScheme of ["light", "dark"])
  pageTest(`has nothing that an accessibility checker finds, ${colorScheme}`, async (page) => {
    await page.evaluate(() => visum.acquire("arm"));
    await page.getByRole("button", { name: "Plot Actual Angle 1" }).click();
    await assertAccessible(page);
    await page.evaluate(() => visum.release("arm"));
    await assertAccessible(page);
  }, { colorScheme });

async function assertAccessible(page) {
  await page.evaluate(readFileSync(require.resolve("axe-core/axe.min.js"), "utf8"));
  const { violations } = await page.evaluate(() => axe.run({ resultTypes: ["violations"] }));
  assert.deepEqual(violations.map(({ id, nodes }) => `${id}: ${nodes.map(({ target }) => target).join(" ")}`), []);
}

test("a lost daemon is told, and regained without a hand", async () => {
  let mine = await Daemon.start();
  const { port, http } = mine;
  const page = await openPage(browser, mine);
  await mine.stop();
  await until(page, () => document.documentElement.dataset.visum === "lost");
  assert.match(await page.getByRole("alert").first().textContent(), /No data from visumd/);
  mine = await Daemon.start("--port", String(port), "--http", String(http));
  await live(page);
  assert.ok(await page.getByRole("alert").first().isHidden());
  await closePages();
  await mine.stop();
});
