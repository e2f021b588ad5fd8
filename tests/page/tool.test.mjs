// The tool: it is jogged, typed and taught, and goes where the world's own poses say that it is.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { body, button, flat, pageTest, settled, until } from "./harness.mjs";
import { bin, source } from "./programs.mjs";

const kHand = "arm/link_7";
const field = (page, axis) => page.getByRole("spinbutton", { name: new RegExp(`^${axis} of the tool`) });
const place = (page) => page.evaluate(() => ["x", "y", "z"].map((axis) => Number(document.querySelector(`[aria-label^="${axis} of the tool"]`).value)));
// Waits until the tool is at a place, within a millimetre. Where it does not come, the error tells what the
// page has said.
const arrives = (page, wanted) =>
  until(page, (goal) => ["x", "y", "z"].every((axis, i) => Math.abs(Number(document.querySelector(`[aria-label^="${axis} of the tool"]`).value) - goal[i]) < 1e-3), wanted).catch(async (error) => {
    throw new Error(`the tool is at ${await place(page)}, not at ${wanted}; the page has said ${await page.evaluate(() => JSON.stringify(window.told))}`, { cause: error });
  });

async function openTool(page) {
  await page.evaluate(() => {
    window.told = []; // all messages, which are shown for seconds only
    const note = (node) => node.classList?.contains("toast") && window.told.push(node.textContent);
    new MutationObserver((changes) => changes.forEach(({ addedNodes }) => addedNodes.forEach(note))).observe(document.body, { childList: true, subtree: true });
  });
  await page.getByRole("tab", { name: "Tool" }).click();
  await page.getByRole("tabpanel", { name: "Tool" }).getByRole("button", { name: "Take control of arm" }).click();
  await usable(page);
}
const usable = (page) => until(page, () => !document.querySelector('[aria-label="Tool z more"]').disabled && document.querySelector('[aria-label^="z of the tool"]').value !== "");

pageTest("the tool is jogged along axes, to typed coordinates, and stops at the end of its reach", async (page, claim) => {
  await openTool(page);
  const start = await place(page);
  await claim("the hand is the tool, before the fingers", async () => {
    assert.equal(await page.getByRole("combobox", { name: "Body that is moved" }).inputValue(), kHand);
  });
  await claim("a step along an axis of the world moves nothing else", async () => {
    await page.getByRole("combobox", { name: "Step" }).selectOption("50 mm · 15°");
    await button(page, "Tool z more").click();
    await arrives(page, [start[0], start[1], start[2] + 0.05]);
  });
  await claim("typed coordinates are reached, also those that are typed while it moves", async () => {
    await field(page, "y").fill(String(start[1] + 0.08));
    await field(page, "y").press("Enter");
    await field(page, "z").fill(String(start[2] + 0.02));
    await field(page, "z").press("Enter");
    await field(page, "z").blur();
    await arrives(page, [start[0], start[1] + 0.08, start[2] + 0.02]);
  });
  await claim("what is selected in a field stays selected while the tool moves", async () => {
    const before = await page.evaluate(() => [1, 2, 3, 4, 5, 6, 7].map((i) => visum.read("arm", `Actual Angle ${i}`)));
    await field(page, "y").fill(String(start[1]));
    await field(page, "y").press("Enter");
    await page.keyboard.press("Control+a");
    await until(page, (from) => from.some((angle, i) => Math.abs(visum.read("arm", `Actual Angle ${i + 1}`) - angle) > 0.03), before);
    await page.keyboard.type(String(start[1] + 0.04));
    await page.keyboard.press("Enter");
    await arrives(page, [start[0], start[1] + 0.04, start[2] + 0.02]);
  });
  await claim("out of reach it stops, and says so", async () => {
    await field(page, "x").fill("3");
    await field(page, "x").press("Enter");
    await page.getByText(/The tool stops: (that is out of reach|a joint)/).waitFor();
    await field(page, "x").blur();
  });
}, flat);

pageTest("a point of the tool stays where it is while the tool turns about it", async (page) => {
  await openTool(page);
  const hand = await place(page);
  await page.getByLabel(/^z of the point that moves/).fill("0.15");
  await page.getByLabel(/^z of the point that moves/).press("Tab");
  await until(page, (z) => Math.abs(Number(document.querySelector('[aria-label^="z of the tool"]').value) - z) > 0.05, hand[2]);
  const tip = await place(page);
  assert.ok(Math.abs(Math.hypot(...tip.map((value, i) => value - hand[i])) - 0.15) < 1e-3, `${hand} to ${tip}`);
  const before = await page.evaluate(() => visum.read("arm", "Actual Angle 2"));
  await page.getByRole("combobox", { name: "Step" }).selectOption("10 mm · 5°");
  await button(page, "Tool pitch more").click();
  await until(page, (angle) => Math.abs(visum.read("arm", "Actual Angle 2") - angle) > 0.01, before);
  await until(page, () => document.querySelector(".chip-words").textContent === "ready");
  await arrives(page, tip);
  await page.reload();
  await page.getByRole("tab", { name: "Tool" }).click();
  assert.equal(await page.getByLabel(/^z of the point that moves/).inputValue(), "0.15");
}, flat);

const chip = (page) => page.getByRole("status", { name: "State of arm" });
const notice = (page) => page.locator(".tool-notice");

pageTest("on its way the tool meets the table: it lets go, and says so", async (page) => {
  await openTool(page);
  for (const [axis, value] of [["x", 0.45], ["y", 0.1], ["z", 0.3]]) {
    await field(page, axis).fill(String(value));
    await field(page, axis).press("Enter");
  }
  await field(page, "z").blur();
  await page.getByText(/The tool stops: arm\/joint_\d stays .* from where it is commanded; look for what holds it/).waitFor();
  // Nothing presses any longer
  await until(page, () => [1, 2, 3, 4, 5, 6, 7].every((i) => Math.abs(visum.read("arm", `Desired Angle ${i}`) - visum.read("arm", `Actual Angle ${i}`)) < 0.01));
  await until(page, () => document.querySelector(".chip-words").textContent === "ready");
}, flat);

pageTest("a slow arm stays on its line, and is offered its speed", async (page) => {
  await openTool(page);
  const start = await place(page);
  await page.evaluate(() => Promise.all([1, 2, 3, 4, 5, 6, 7].map((i) => visum.write("arm", `Maximum Speed ${i}`, 0.01))));
  await page.getByText("Maximum Speed 1 is 0.0100 rad/s: the tool is slow.").waitFor();
  await field(page, "y").fill("0.15");
  await field(page, "y").press("Enter");
  await field(page, "y").blur();
  const from = await page.evaluate(() => visum.simTime());
  await until(page, (time) => visum.simTime() > time + 3, from);
  const [x, y, z] = await place(page);
  assert.ok(y > 0.005 && y < 0.1 && Math.hypot(x - start[0], z - start[2]) < 0.005, `from ${start} to ${[x, y, z]}`);
  await button(page, "Full speed").click();
  await arrives(page, [start[0], 0.15, start[2]]);
  assert.ok(await notice(page).isHidden());
}, flat);

pageTest("in a fault the tool takes nothing; a switched-off drive gets its supply off and on, and needs its rest", async (page) => {
  await openTool(page);
  await page.evaluate(() => visum.write("arm", "Desired Angle 2", 0.95)); // into the table
  const end = chip(page).getByRole("button", { name: "Supply off and on, Reset" });
  await end.waitFor();
  await until(page, () => /arm is in fault; see the bar above/.test(document.querySelector(".tool-notice").textContent));
  assert.ok(await field(page, "x").isDisabled());
  await button(page, "Log").click();
  await page.getByRole("combobox", { name: "Kind of event" }).selectOption("faults");
  await page.locator(".log-line", { hasText: "'arm' has tripped: joint_2: " }).first().waitFor();
  assert.match(await chip(page).locator(".chip-reason").textContent(), /switch the supply off and on, wait \d+ s, then Reset/);
  await end.click();
  await page.getByText(/arm: Reset did not end the fault\. joint_2: /).waitFor();
  // Not before: the drive's rest would be over before the page's next click.
  await page.getByRole("combobox", { name: "Speed" }).selectOption("10×");
  const from = await page.evaluate(() => visum.simTime());
  await until(page, (time) => visum.simTime() > time + 20, from);
  await end.click();
  await until(page, () => document.querySelector(".chip-words").textContent === "ready");
  await until(page, () => !document.querySelector('[aria-label="Tool z more"]').disabled);
}, { ...flat, daemon: ["-v", "2"] });

pageTest("the tool is dragged by its handles in the view, and the arm follows", async (page) => {
  await openTool(page);
  await settled(page, kHand);
  const [from, before] = [await body(page, kHand), await place(page)];
  await page.mouse.move(from.x, from.y);
  await page.mouse.down();
  await page.mouse.move(from.x - 40, from.y - 30, { steps: 5 });
  // As far as the pointer went, within a few pixels
  await until(page, ({ x, y }) => {
    const now = visum.project("arm/link_7");
    return Math.hypot(now.x - x, now.y - y) < 6;
  }, { x: from.x - 40, y: from.y - 30 });
  await page.mouse.up();
  const after = await place(page);
  assert.ok(Math.hypot(...after.map((value, i) => value - before[i])) > 0.03, JSON.stringify([before, after]));
  assert.notEqual(await page.locator(".chip").getAttribute("data-tone"), "bad");
});

pageTest("poses are taught, kept, played, and exported as programs that run", async (page, claim, daemon) => {
  await openTool(page);
  await button(page, "Save pose").click();
  const start = await place(page);
  await page.getByRole("combobox", { name: "Step" }).selectOption("50 mm · 15°");
  await button(page, "Tool z more").click();
  await arrives(page, [start[0], start[1], start[2] + 0.05]);
  await button(page, "Save pose").click();
  await claim("they are kept, and played in their order", async () => {
    await page.reload();
    await page.getByText("This page commands arm again").waitFor();
    await page.getByRole("tab", { name: "Tool" }).click();
    await usable(page);
    await button(page, "Pose 1 later").click();
    await button(page, "Play").click();
    await arrives(page, start);
    await button(page, "Play").waitFor();
  });
  const folder = mkdtempSync(join(tmpdir(), "visum-taught-"));
  const exported = async (name) => {
    const [saved] = await Promise.all([page.waitForEvent("download"), button(page, name).click()]);
    await saved.saveAs(join(folder, saved.suggestedFilename()));
    return join(folder, saved.suggestedFilename());
  };
  try {
    await claim("the controller in Python goes there", async () => {
      const file = await exported("Python");
      await page.evaluate(async () => {
        await visum.write("arm", "Desired Angle 1", 0.2);
        await visum.release("arm");
      });
      const environment = { ...process.env, PYTHONPATH: join(bin, "../python") };
      execFileSync("/usr/bin/python3", [file, `127.0.0.1:${daemon.port}`], { env: environment, timeout: 120_000 });
      await arrives(page, start);
    });
    await claim("the scenario passes", async () => {
      const file = await exported("Scenario");
      const text = readFileSync(file, "utf8").replace(/^scene: .*$/m, `scene: ${join(source, "models/scenes/amtec_arm.yaml")}`);
      writeFileSync(file, text);
      execFileSync(join(bin, "visum"), ["run", file], { timeout: 240_000 });
    });
  } finally {
    rmSync(folder, { recursive: true });
  }
}, flat);
