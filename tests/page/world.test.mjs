// The log, the menu "World", layouts, and leases over a reload.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync, mkdtempSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { button, control, flat, pageTest, until } from "./harness.mjs";
import { bin, Daemon, live, source } from "./programs.mjs";

const visum = (daemon, ...words) => execFileSync(join(bin, "visum"), [...words, "--connect", `127.0.0.1:${daemon.port}`]);
const lines = (page) => page.getByRole("listbox", { name: "What happened" });
const line = (page, text) => lines(page).getByRole("option").filter({ hasText: text });
const marks = (page) => page.locator(".ruler .mark").count();

// A daemon that keeps its files in a folder of its own.
class Keeping extends Daemon {
  static async start() {
    const daemon = new Keeping();
    daemon.folder = mkdtempSync(join(tmpdir(), "visum-files-"));
    await daemon.serve("--files", daemon.folder);
    return daemon;
  }
  async stop() {
    await super.stop();
    rmSync(this.folder, { recursive: true });
  }
}

pageTest("the log tells what happens, filtered, with a mark for each on a ruler", async (page, claim, daemon) => {
  visum(daemon, "fault", "arm", "encoder_noise", "joint=2", "deviation=0.001");
  await button(page, "Log").click();
  await claim("also what happened before the page came", () => line(page, "encoder_noise").first().waitFor());
  await control(page);
  await claim("who commands", () => line(page, /lease_granted · arm · page [0-9a-f]{4}/).first().waitFor());
  await claim("of one kind, of a level, with words", async () => {
    await page.getByRole("combobox", { name: "Kind of event" }).selectOption("control");
    await line(page, "encoder_noise").waitFor({ state: "detached" });
    await page.getByRole("combobox", { name: "Kind of event" }).selectOption("");
    await page.getByRole("searchbox", { name: "Search the log" }).fill("noise arm");
    await until(page, () => document.querySelectorAll(".log-line").length === 1);
    await page.getByRole("searchbox", { name: "Search the log" }).fill("nothing is called so");
    await page.getByText("Nothing that matches has happened.").waitFor();
    await page.getByRole("searchbox", { name: "Search the log" }).fill("");
  });
  await claim("a mark leads to its line", async () => {
    await until(page, () => document.querySelector('.mark[title*="encoder_noise"]'));
    await page.locator('.mark[title*="encoder_noise"]').evaluate((mark) => mark.click());
    assert.equal(await line(page, "encoder_noise").first().getAttribute("aria-selected"), "true");
  });
  await claim("keys go from line to line", async () => {
    await lines(page).focus();
    await page.keyboard.press("ArrowDown");
    assert.equal(await line(page, "encoder_noise").first().getAttribute("aria-selected"), "false");
    assert.equal(await lines(page).locator('[aria-selected="true"]').count(), 1);
  });
}, flat);

pageTest("the menu World: bookmarks with undo, a recording, faults, bodies", async (page, claim, daemon) => {
  const menu = page.locator(".world");
  const open = async () => (await menu.evaluate((details) => details.open)) || (await page.getByRole("button", { name: "World", exact: true }).click());
  const press = async (name) => (await open(), menu.getByRole("button", { name, exact: true }).click());
  await claim("a state is kept by its name, and gone back to", async () => {
    await open();
    await menu.getByLabel("Name of the bookmark").fill("before");
    await press("Bookmark");
    await menu.getByText("before", { exact: true }).waitFor();
    const kept = await page.evaluate(() => visum.simTime());
    await until(page, (time) => visum.simTime() > time + 0.5, kept);
    const later = await page.evaluate(() => visum.simTime());
    await press("Go back to before");
    await until(page, (time) => visum.simTime() < time, later);
    await page.locator(".toast").getByRole("button", { name: "Undo" }).press("Enter");
    await until(page, (time) => visum.simTime() >= time, later);
    assert.ok(existsSync(join(daemon.folder, "before.snapshot.mcap")));
  });
  await claim("a recording is begun and ended", async () => {
    await open();
    await menu.getByLabel("Name of the recording").fill("monday");
    await press("Record");
    await menu.getByText("The server writes monday.mcap").waitFor();
    await press("Stop recording");
    await menu.getByRole("button", { name: "Record", exact: true }).waitFor();
    assert.ok(existsSync(join(daemon.folder, "monday.mcap")));
  });
  await claim("a fault by click, with its effect in words, and its end", async () => {
    await open();
    const kind = await menu.getByRole("combobox", { name: "Fault", exact: true }).inputValue();
    assert.ok((await menu.locator(".fault-effect").textContent()).length > 10);
    await press("Break it");
    await menu.locator(".active-faults li", { hasText: kind }).first().waitFor();
    await menu.locator(".active-faults").getByRole("button").first().click();
    await until(page, () => document.querySelectorAll(".active-faults li").length === 0);
  });
  await claim("a body comes and goes", async () => {
    await press("Add");
    await until(page, () => visum.bodies().includes("box_2"));
    await open();
    await menu.getByRole("combobox", { name: "Body to remove" }).selectOption("box_2");
    await press("Remove");
    await until(page, () => !visum.bodies().includes("box_2"));
  });
  await claim("a model of the server's comes with its part, is commanded, and goes", async () => {
    await open();
    await menu.getByRole("combobox", { name: "Model to add" }).selectOption("cart/cart.yaml");
    await menu.getByLabel("Name of the model; empty: its file's").fill("second");
    await menu.getByLabel(/^Place of the model/).fill("0, 2, 0, 90");
    await press("Add the model");
    await page.locator(".toast").getByText("'second' is here, with the part").waitFor();
    await until(page, () => visum.bodies().some((name) => name.startsWith("second/")));
    await page.getByRole("region", { name: "Part second", exact: true }).waitFor();
    await until(page, () => visum.ports().some(({ part, value }) => part === "second" && Number.isFinite(value)));
    await page.evaluate(() => visum.acquire("second"));
    const lists = () => JSON.parse(execFileSync(join(bin, "visum"), ["spawn", "--list", "--json", "--connect", `127.0.0.1:${daemon.port}`])).spawned;
    assert.deepEqual(lists(), ["second"]);
    await press("Remove the model second");
    await page.getByRole("region", { name: "Part second", exact: true }).waitFor({ state: "detached" });
    assert.deepEqual(lists(), []);
    assert.equal(await page.getByRole("region", { name: "Part arm", exact: true }).count(), 1, "the other parts stay");
  });
  await claim("a model of this machine is sent with its meshes; one that cannot be read says why", async () => {
    await open();
    const picked = page.waitForEvent("filechooser");
    await press("Your folder…");
    await (await picked).setFiles(join(source, "models/amtec_arm"));
    await menu.getByRole("combobox", { name: "Model to add" }).selectOption("own/amtec_arm/amtec_arm.urdf");
    await menu.getByLabel("Name of the model; empty: its file's").fill("mine");
    await press("Add the model");
    await until(page, () => visum.bodies().includes("mine/link_7"));
    await menu.getByLabel(/^Place of the model/).fill("somewhere");
    await press("Add the model");
    await page.locator(".toast.error").getByText("The place must be x, y, z in m").waitFor();
  });
}, { serve: () => Keeping.start(), ...flat });

pageTest("a layout is kept for its scene, and shared by a link", async (page, claim, daemon) => {
  await button(page, "Plot Actual Angle 2").click();
  await page.getByRole("combobox", { name: "Length of the time axis" }).selectOption("30 s");
  await button(page, "Parts").click();
  await claim("kept over a reload", async () => {
    await page.reload();
    await live(page);
    await page.getByRole("region", { name: "Plot", exact: true }).waitFor();
    assert.equal(await page.getByRole("combobox", { name: "Length of the time axis" }).inputValue(), "30");
    assert.ok(await page.locator(".pane.parts").isHidden());
  });
  await claim("and by a link elsewhere", async () => {
    await button(page, "Copy a link to this layout").click();
    await until(page, () => location.hash.startsWith("#layout="));
    const other = await (await page.context().browser().newContext()).newPage();
    await other.goto(await page.evaluate(() => location.href));
    await live(other);
    await other.getByRole("region", { name: "Plot", exact: true }).waitFor();
    assert.ok(await other.locator(".pane.parts").isHidden());
    await other.context().close();
  });
}, flat);

pageTest("a page that is reloaded asks first, and commands again what it commanded", async (page, claim) => {
  await button(page, "Take control of arm").click();
  await until(page, () => document.querySelector(".part .holder").textContent === "yours");
  await button(page, "Joint 1 more").click();
  await until(page, () => visum.read("arm", "Desired Angle 1") > 0);
  const wanted = await page.evaluate(() => visum.read("arm", "Desired Angle 1"));
  const asked = [];
  page.on("dialog", (dialog) => (asked.push(dialog.type()), dialog.accept()));
  await page.reload();
  await live(page);
  await page.getByText("This page commands arm again").waitFor();
  assert.deepEqual(asked, ["beforeunload"]);
  await claim("no part has stopped meanwhile, and the values are as before", async () => {
    // It may still be on its way. One that has stopped would not become ready by itself.
    await until(page, () => document.querySelector(".chip").dataset.tone === "good");
    assert.equal(await page.evaluate(() => visum.read("arm", "Desired Angle 1")), wanted);
  });
}, flat);
