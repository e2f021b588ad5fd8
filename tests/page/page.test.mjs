// The user's basics: commands, leases, roles, time, tokens, access, losing the daemon and finding it again.
import assert from "node:assert/strict";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { axeFindings, browser, browserTest, button, closePages, control, pageTest, until } from "./harness.mjs";
import { Daemon, live, openPage, source } from "./programs.mjs";

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

pageTest("the second writer is refused, and told who holds the lease", async (page, _, daemon) => {
  const other = await openPage(browser, daemon);
  await other.evaluate(() => visum.acquire("arm"));
  await until(page, () => /^page /.test(document.querySelector(".part .holder").textContent));
  await assert.rejects(page.evaluate(() => visum.write("arm", "Desired Angle 1", 0.1)), /lease/);
  await assert.rejects(page.evaluate(() => visum.acquire("arm")), /holds|held|lease/);
  await other.evaluate(() => visum.release("arm"));
  await until(page, () => document.querySelector(".part .holder").textContent === "free");
});

pageTest("another role begins with every lease released, and no part stops", async (page) => {
  await control(page);
  const state = await page.evaluate(() => visum.read("arm", "Part State"));
  const session = await page.locator(".connection").getAttribute("title");
  await page.getByRole("combobox", { name: "Role" }).selectOption("Observer");
  await until(page, (before) => document.querySelector(".connection").title !== before, session);
  await live(page);
  const from = await page.evaluate(() => visum.simTime());
  await until(page, (time) => visum.simTime() > time + 0.3, from);
  assert.equal(await page.evaluate(() => visum.read("arm", "Part State")), state);
  assert.ok(await button(page, "Take control").first().isDisabled());
});

// Longer than any of the server's deadlines, with samples of every tick on the way.
pageTest("a page that the machine keeps from running keeps its session and its lease", async (page) => {
  await button(page, "Plot Actual Angle 1").click();
  await control(page);
  await page.evaluate(() => {
    for (const end = performance.now() + 4500; performance.now() < end; );
  });
  const from = await page.evaluate(() => visum.simTime());
  await until(page, (time) => visum.simTime() > time + 0.5, from);
  assert.equal(await page.evaluate(() => document.documentElement.dataset.visum), "live");
  await page.evaluate(() => visum.write("arm", "Desired Angle 1", 0.1));
});

pageTest("pauses, steps by one and by many, goes on, slower, and from the beginning", async (page) => {
  await page.keyboard.down(" ");
  await page.getByRole("button", { name: "Run" }).waitFor();
  await page.keyboard.down(" "); // held down, the key repeats: that is no press more
  await page.keyboard.up(" ");
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
  await page.getByRole("spinbutton", { name: "Number of ticks" }).fill("600000");
  await page.getByRole("button", { name: "ticks", exact: true }).click();
  await page.getByRole("button", { name: "Pause" }).click(); // ten minutes of them are not waited for
  await page.getByRole("button", { name: "Run" }).click();
  const from = await page.evaluate(() => visum.simTime());
  await until(page, (time) => visum.simTime() > time + 0.3, from);
  // A tenth of the speed: less than a second of the world in all the time that the status needs to tell of
  // it.
  await page.getByRole("combobox", { name: "Speed" }).selectOption("0.1×");
  await until(page, () => Number(document.querySelector(".meter-value").textContent) < 0.2);
  await button(page, "Reset the world").click();
  await until(page, (time) => visum.simTime() < time, from);
});

for (const colorScheme of ["light", "dark"])
  pageTest(`has nothing that an accessibility checker finds, ${colorScheme}`, async (page) => {
    await page.evaluate(() => visum.acquire("arm"));
    await page.getByRole("button", { name: "Plot Actual Angle 1" }).click();
    for (const summary of await page.locator("summary", { hasText: /^(Parameters|Blackboards|Cycle)/ }).all()) await summary.click();
    await page.locator(".parameter").first().waitFor();
    await assertAccessible(page);
    await page.evaluate(() => visum.release("arm"));
    await assertAccessible(page);
    await page.getByRole("tab", { name: "Tool" }).click();
    await button(page, "Log").click();
    await page.locator(".log-line").first().waitFor();
    await button(page, "World").click();
    await until(page, () => document.querySelector(".fault-effect").textContent !== "" && document.querySelectorAll(".names li").length > 2);
    await page.getByRole("searchbox", { name: "Search scenarios" }).fill("wave");
    await button(page, "Start two_link_wave").click();
    await until(page, () => document.querySelector(".verdict").textContent === "passed");
    await assertAccessible(page);
  }, { colorScheme });

const assertAccessible = async (page) => assert.deepEqual(await axeFindings(page), []);

for (const [width, height] of [[1280, 720], [768, 1024], [1024, 768], [390, 844], [640, 360]])
  pageTest(`fits a screen of ${width} by ${height}`, async (page) => {
    await button(page, "Plots").click(); // on a small screen this closes the others
    if (height > 700) await page.getByRole("combobox", { name: "Selected body" }).selectOption("box");
    await until(page, () => !document.querySelector(".pane.plots").hidden && document.querySelector(".view canvas").clientWidth > 200);
    const outside = await page.evaluate(() => [...document.querySelectorAll("button, select, input, output, .meter, canvas")]
      .filter((element) => element.checkVisibility() && !element.closest(".tree-body, .panel-scroll, .popover-body"))
      .filter((element) => {
        const { left, right, top, bottom } = element.getBoundingClientRect();
        return left < 0 || top < 0 || right > innerWidth + 0.5 || bottom > innerHeight + 0.5;
      })
      .map((element) => `${element.tagName} ${element.className} ${element.ariaLabel}`));
    assert.deepEqual(outside, []);
    const covered = await page.evaluate(() => [...document.querySelectorAll(".bar button, .bar select, .bar input, .pane-head button, .body-card button")]
      .filter((element) => element.checkVisibility())
      .filter((element) => {
        const { left, right, top, bottom } = element.getBoundingClientRect();
        return !element.contains(document.elementFromPoint((left + right) / 2, (top + bottom) / 2));
      })
      .map((element) => element.ariaLabel ?? element.textContent));
    assert.deepEqual(covered, []);
    const root = await page.evaluate(() => [document.documentElement.scrollWidth, document.documentElement.scrollHeight]);
    assert.deepEqual(root, [width, height]);
  }, { viewport: { width, height } });

browserTest("where a token is set, the page asks for it", async () => {
  const folder = mkdtempSync(join(tmpdir(), "visum-page-"));
  const token = "0123456789abcdef0123456789abcdef";
  writeFileSync(join(folder, "token"), `admin ${token}\n`, { mode: 0o600 });
  const daemon = await Daemon.start("--token-file", join(folder, "token"));
  try {
    const page = await browser.newPage();
    await page.goto(daemon.url);
    const field = page.getByLabel("Token");
    await field.waitFor();
    await field.fill("not this one, of the same length");
    await field.press("Enter");
    await field.waitFor();
    assert.equal(await page.evaluate(() => visum.ports().length), 0);
    await field.fill(token);
    await field.press("Enter");
    await live(page);
    assert.ok(!page.url().includes(token));
  } finally {
    await closePages();
    await daemon.stop();
    rmSync(folder, { recursive: true });
  }
});

browserTest("a lost daemon is told, and regained without a hand", async () => {
  let mine = await Daemon.start();
  const { port, http } = mine;
  try {
    const page = await openPage(browser, mine);
    await mine.stop();
    await until(page, () => document.documentElement.dataset.visum === "lost");
    assert.match(await page.getByRole("alert").first().textContent(), /No data from visumd/);
    mine = await Daemon.start("--port", String(port), "--http", String(http));
    await live(page);
    await page.getByRole("alert").first().waitFor({ state: "hidden" });
  } finally {
    await closePages();
    await mine.stop();
  }
});

browserTest("another scene leaves nothing of the one before", async () => {
  let mine = await Daemon.start();
  const { port, http } = mine;
  try {
    const page = await openPage(browser, mine);
    await control(page);
    await button(page, "Hold Desired Angle 1").click();
    await page.locator("summary", { hasText: "Blackboards" }).click();
    await until(page, () => document.querySelector(".blackboard pre"));
    await mine.stop();
    await page.getByText("No longer held: Desired Angle 1 (the lease of 'arm' is lost)").waitFor();
    assert.equal(await page.locator(".part .holder").first().isVisible(), false, "nobody holds a lease of a server that is gone");
    assert.ok(await button(page, "Joint 1 more").isDisabled());
    mine = await Daemon.start(join(source, "models/scenes/cart.yaml"), "--port", String(port), "--http", String(http));
    await live(page);
    assert.equal(await page.locator(".missing").count(), 0, "nor a panel of its parts");
    const from = await page.evaluate(() => visum.simTime());
    // Twice what lets blackboards be read again
    await until(page, (time) => visum.simTime() > time + 2.5, from);
    const errors = await page.locator(".toast.error").allTextContents();
    assert.deepEqual(errors.filter((text) => !text.startsWith("No longer held")), []);
  } finally {
    await closePages();
    await mine.stop();
  }
});
