// States in words, the stop, a frozen world, a reset that others notice, a browser without 3D: all that
// keeps a user out of trouble.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { join } from "node:path";
import { body, browser, button, drawn, flat, pageTest, until } from "./harness.mjs";
import { bin, live, openPage, source } from "./programs.mjs";

const chip = (page) => page.getByRole("status", { name: "State of arm" });
const says = (page, words) => until(page, (text) => document.querySelector(".chip").textContent.includes(text), words);
const visum = (daemon, ...words) => execFileSync(join(bin, "visum"), [...words, "--connect", `127.0.0.1:${daemon.port}`]);

pageTest("a part's state is told in words, and every stop ends by a button beside it", async (page, claim) => {
  await says(page, "ready");
  await claim("Stop, without a lease", async () => {
    await button(page, "Stop").click();
    await says(page, "the emergency stop is pressed");
    assert.equal(await page.evaluate(() => visum.ports().find(({ port }) => port === "Execution Enable").value), 1);
  });
  await claim("released, it is a fault that says why, and Reset ends it", async () => {
    await chip(page).getByRole("button", { name: "Release stop" }).click();
    await says(page, "fault");
    await until(page, () => /joint_1: .*(supply|voltage)/i.test(document.querySelector(".chip-reason").textContent));
    await chip(page).getByRole("button", { name: "Reset" }).click();
    await says(page, "ready");
  });
  await claim("Escape closes a menu first, and stops then", async () => {
    await button(page, "Overlays").click();
    await page.keyboard.press("Escape");
    assert.equal(await page.locator("details.popover[open]").count(), 0);
    assert.equal(await page.locator(".chip").getAttribute("data-tone"), "good");
    await page.keyboard.press("Escape");
    await says(page, "stopped");
  });
});

pageTest("sliders end at the soft limits, and show limits, command and actual value", async (page) => {
  const slider = page.getByRole("slider", { name: "Joint 2", exact: true });
  const [least, most] = [Number(await slider.getAttribute("min")), Number(await slider.getAttribute("max"))];
  assert.deepEqual([least, most], [-2.22, 2.22]);
  const widget = page.getByRole("group", { name: "Joint 2", exact: true });
  assert.match(await widget.textContent(), /−2\.22.*2\.22 rad/);
  await button(page, "Take control of arm").click();
  // Unlike a click, a key does not wait until the slider may be used.
  await until(page, () => !document.querySelector('[aria-label="Joint 2"] input').disabled);
  await slider.press("End"); // beyond it the port still takes 9 rad
  await until(page, () => visum.read("arm", "Desired Angle 2") === 2.22);
  await until(page, () => visum.read("arm", "Actual Angle 2") > -0.35);
  const [wanted, actual] = await page.evaluate(() => {
    const of = (name) => document.querySelector(`[aria-label="Joint 2"] .${name}`).textContent.replace("−", "-");
    return [Number(of("slider-value")), Number(of("slider-actual"))];
  });
  assert.equal(wanted, 2.22);
  assert.ok(actual < 2 && actual > -0.4, `${actual}`);
}, flat);

pageTest("a frozen world says so, and why, and is revived by Reset", async (page, _, daemon) => {
  visum(daemon, "push", "box", "0", "0", "1e6", "--for", "2");
  const banner = page.getByRole("alert").filter({ hasText: "The world is frozen" });
  await banner.waitFor();
  assert.match(await banner.textContent(), /box/);
  await until(page, () => /^Frozen/.test(document.querySelector(".connection").textContent));
  const frozenAt = await page.evaluate(() => visum.simTime());
  await banner.getByRole("button", { name: "Reset the world" }).click();
  await banner.waitFor({ state: "hidden" });
  await until(page, (time) => visum.simTime() < time || visum.simTime() > time + 0.2, frozenAt);
}, { daemon: ["--dump", "off"], ...flat });

pageTest("a reset asks where others are connected, is told to them, and can be undone", async (page, claim, daemon) => {
  await until(page, () => visum.simTime() > 0.5);
  await claim("alone, it only offers to undo it", async () => {
    const before = await page.evaluate(() => visum.simTime());
    await button(page, "Reset the world").click();
    await until(page, (time) => visum.simTime() < time, before);
    await page.locator(".toast").getByRole("button", { name: "Undo" }).press("Enter");
    await until(page, (time) => visum.simTime() >= time, before);
  });
  const other = await openPage(browser, daemon, flat);
  await other.evaluate(() => visum.acquire("arm"));
  const name = await other.evaluate(() => document.querySelector(".part .holder").title);
  assert.match(name, /This page holds/);
  await until(page, () => /^page /.test(document.querySelector(".part .holder").textContent));
  await claim("a page that commands is named, and nothing happens without a yes", async () => {
    const before = await page.evaluate(() => visum.simTime());
    await button(page, "Reset the world").click();
    const question = page.getByRole("dialog");
    assert.match(await question.textContent(), /'page [0-9a-f]{4}' commands a part of it/);
    await page.keyboard.press("Enter"); // the focus is on Cancel
    await question.waitFor({ state: "detached" });
    await until(page, (time) => visum.simTime() > time, before);
    await button(page, "Reset the world").press("Enter");
    await question.getByRole("button", { name: "Reset the world" }).press("Enter");
    await until(page, (time) => visum.simTime() < time, before);
  });
  await claim("and told", () => other.locator(".toast", { hasText: "The world was reset" }).first().waitFor());
}, flat);

pageTest("ports, panels and plots work in a browser without WebGL", async (page) => {
  await page.getByText("No 3D view here").waitFor();
  await button(page, "Plot Actual Angle 1").click();
  await button(page, "Take control of arm").click();
  await button(page, "Joint 1 more").click();
  await until(page, () => visum.read("arm", "Actual Angle 1") > 0.03);
  // Held, it goes on
  const step = await page.evaluate(() => visum.read("arm", "Desired Angle 1"));
  await button(page, "Joint 1 more").hover();
  await page.mouse.down();
  await until(page, (by) => visum.read("arm", "Desired Angle 1") > 3.5 * by, step);
  await page.mouse.up();
  await until(page, () => document.querySelectorAll(".plot .u-series").length === 2);
}, flat);

pageTest("a first visit gets first steps, once; a key shows the keys", async (page) => {
  const steps = page.getByRole("region", { name: "First steps" });
  assert.match(await steps.textContent(), /Take control.*the tab “Tool”.*Stop/);
  await steps.getByRole("button", { name: "Got it" }).press("Enter");
  await steps.waitFor({ state: "detached" });
  await page.locator("main").focus();
  await page.keyboard.press("?");
  const keys = page.getByRole("dialog", { name: "Keys" });
  assert.match(await keys.textContent(), /Escape.*stops all parts/);
  await page.keyboard.press("Escape"); // closes it, and stops nothing
  await keys.waitFor({ state: "detached" });
  assert.equal(await page.locator(".chip").getAttribute("data-tone"), "good");
  await page.reload();
  await live(page);
  assert.equal(await steps.count(), 0);
}, { firstVisit: true, ...flat });

pageTest("the first steps are those of this world, and beside its cameras", async (page) => {
  const steps = page.getByRole("region", { name: "First steps" });
  assert.doesNotMatch(await steps.textContent(), /Take control|Tool/);
  await page.getByRole("button", { name: "Camera eye_0" }).locator("canvas").waitFor();
  await steps.getByRole("button", { name: "Got it" }).click(); // nothing lies over it
  await steps.waitFor({ state: "detached" });
}, { firstVisit: true, daemon: [join(source, "models/scenes/eight_cameras.yaml")] });

// The corners of the table, which is the largest thing of the scene.
const kCorners = [-0.25, 0.25].flatMap((x) => [-0.5, 0.5].flatMap((y) => [-0.1, 0.1].map((z) => [x, y, z])));

pageTest("Home shows all of the world, also when the window changes", async (page) => {
  for (const [width, height] of [[1280, 720], [700, 900]]) {
    await page.setViewportSize({ width, height });
    await until(page, (w) => document.querySelector(".view").clientWidth <= w && window.innerWidth === w, width);
    await drawn(page);
    const view = await page.locator(".view > canvas").boundingBox();
    for (const corner of kCorners) {
      const { x, y } = await body(page, "table", corner);
      assert.ok(x > view.x && x < view.x + view.width && y > view.y && y < view.y + view.height, `${width} by ${height}: ${corner} is at ${x}, ${y}`);
    }
  }
});

pageTest("cameras are live tiles, and nobody is asked to command them", async (page) => {
  const tile = page.getByRole("region", { name: "Cameras" }).getByRole("button", { name: "Camera camera", exact: true });
  await tile.locator("canvas").waitFor();
  const taken = () => page.evaluate(() => document.querySelector(".tile canvas").getAttribute("aria-label"));
  const first = await taken();
  await tile.click();
  await until(page, (text) => document.querySelector(".tile canvas").getAttribute("aria-label") !== text, first);
  assert.equal(await tile.getAttribute("aria-pressed"), "true");
  await page.keyboard.press("Escape"); // makes it small again, and stops nothing
  assert.equal(await tile.getAttribute("aria-pressed"), "false");
  assert.equal(await page.getByText(/^The world is paused/).count(), 0);
  assert.equal(await button(page, "Take control").count(), 0);
  assert.ok(await page.getByRole("combobox", { name: "Panel" }).isVisible(), "and what they measure is a panel");
}, { daemon: [join(source, "models/scenes/sensors.yaml")] });
