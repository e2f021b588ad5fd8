// The log, the menu "World", layouts, and leases over a reload.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync, mkdirSync, mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { axeFindings, browser, button, control, drawn, flat, pageTest, until } from "./harness.mjs";
import { bin, Daemon, live, openPage, source } from "./programs.mjs";

const visum = (daemon, ...words) => execFileSync(join(bin, "visum"), [...words, "--connect", `127.0.0.1:${daemon.port}`]);
const lines = (page) => page.getByRole("listbox", { name: "What happened" });
const line = (page, text) => lines(page).getByRole("option").filter({ hasText: text });
const marks = (page) => page.locator(".ruler .mark").count();

// A daemon that keeps its files in a folder of its own. `optionsFor` may write more into it.
class Keeping extends Daemon {
  static async start(optionsFor = () => []) {
    const daemon = new Keeping();
    daemon.folder = mkdtempSync(join(tmpdir(), "visum-files-"));
    await daemon.serve("--files", daemon.folder, ...optionsFor(daemon.folder));
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

pageTest("at phone width the menu World chooses the role", async (page, claim) => {
  const menu = page.locator(".world");
  const role = menu.getByRole("combobox", { name: "Role" });
  await page.getByRole("button", { name: "World", exact: true }).click();
  await claim("it is the only choice of the role", async () => {
    await role.waitFor();
    assert.equal(await page.getByRole("combobox", { name: "Role" }).count(), 1);
    assert.equal(await role.locator(":checked").textContent(), "Admin");
  });
  await claim("an observer changes nothing, and reads why", async () => {
    await role.selectOption("Observer");
    await menu.getByText("Only an administrator changes the world.").waitFor();
    await role.selectOption("Admin");
    await menu.getByText("Only an administrator changes the world.").waitFor({ state: "hidden" });
  });
}, { viewport: { width: 390, height: 844 }, ...flat });

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

const inMenu = (page) => page.locator(".world");
async function openMenu(page) {
  if (!(await inMenu(page).evaluate((details) => details.open))) await button(page, "World").click();
  return inMenu(page);
}
const scenes = (page) => inMenu(page).getByRole("list", { name: "scenes", exact: true });
const shownNames = (list) => list.locator("li:visible .menu-name").allTextContents();
const load = async (page, name) => (await openMenu(page), scenes(page).getByRole("button", { name: `Load ${name}`, exact: true }).click());
const isShown = (page, scene) => until(page, (title) => document.title === title && document.documentElement.dataset.visum === "live", `${scene} · Visum`);

pageTest("another scene is chosen on the page, which is then as after connecting anew", async (page, claim, daemon) => {
  const name = await page.evaluate(() => document.querySelector(".connection").title.match(/page [0-9a-f]{4}/)[0]);
  await button(page, "Plot Actual Angle 2").click();
  await page.locator(".view canvas").focus();
  await page.keyboard.press("ArrowLeft");
  await claim("by a search among the server's scenes; the present one is marked", async () => {
    await openMenu(page);
    await scenes(page).getByText("amtec_arm").waitFor();
    assert.deepEqual(await scenes(page).locator(".here .menu-name").allTextContents(), ["amtec_arm"]);
    await inMenu(page).getByRole("searchbox", { name: "Search scenes" }).fill("cart");
    assert.deepEqual(await shownNames(scenes(page)), ["cart", "cart_fleet"]);
  });
  await claim("alone, nobody is asked; view, parts, panel and plots are those of the scene", async () => {
    // It goes by itself.
    const told = page.locator(".toast", { hasText: "The scene 'cart' was loaded" }).first().waitFor();
    await load(page, "cart");
    await Promise.all([isShown(page, "cart"), told]);
    await page.getByRole("region", { name: "Part cart", exact: true }).waitFor();
    assert.equal(await page.getByRole("region", { name: "Part arm", exact: true }).count(), 0);
    assert.equal(await page.locator(".scene").textContent(), "cart");
    assert.ok((await page.evaluate(() => visum.bodies())).includes("cart/chassis"));
    assert.equal(await page.locator(".plot").count(), 0);
    assert.deepEqual(await scenes(page).locator(".here .menu-name").allTextContents(), ["cart"]);
    await drawn(page);
    const fresh = await openPage(browser, daemon);
    const [seen, expected] = await Promise.all([page, fresh].map((one) => one.evaluate(() => ({
      ports: visum.ports().map(({ part, port }) => `${part}/${port}`), bodies: visum.bodies(), camera: visum.camera().fov,
      panels: [...document.querySelectorAll(".panel-choice option")].map(({ textContent }) => textContent),
      panel: document.querySelector(".panel-choice").selectedOptions[0].textContent,
      viewpoints: [...document.querySelectorAll('[aria-label="Viewpoint"] option')].map(({ textContent }) => textContent),
      chips: [...document.querySelectorAll(".chip-name")].map(({ textContent }) => textContent),
    }))));
    assert.deepEqual(seen, expected);
    const cameras = await Promise.all([page, fresh].map((one) => one.evaluate(() => visum.camera().position)));
    cameras[0].forEach((value, i) => assert.ok(Math.abs(value - cameras[1][i]) < 0.01, JSON.stringify(cameras)));
    await fresh.context().close();
  });
  await claim("its samples come, and it is commanded", async () => {
    const port = await page.evaluate(() => visum.ports().find(({ side }) => side === "input").port);
    await page.evaluate(() => visum.acquire("cart"));
    await page.evaluate(([port]) => visum.write("cart", port, 0.25), [port]);
    await until(page, (port) => visum.read("cart", port) === 0.25, port);
  });
  const other = await openPage(browser, daemon, flat);
  await claim("where others are connected, the page asks, and nothing happens without a yes", async () => {
    await load(other, "amtec_arm");
    const question = other.getByRole("dialog");
    assert.match(await question.textContent(), new RegExp(`Load the scene 'amtec_arm' in place of this world\\? '${name}' commands a part of it`));
    await other.keyboard.press("Enter"); // the focus is on Cancel
    await question.waitFor({ state: "detached" });
    assert.equal(await other.title(), "cart · Visum");
    await load(other, "amtec_arm");
    await question.getByRole("button", { name: "Load the scene" }).click();
  });
  await claim("all pages show the scene, and the plots that were kept for it", async () => {
    for (const one of [page, other]) await isShown(one, "amtec_arm");
    assert.ok(await inMenu(other).evaluate(({ open }) => open), "the answer to the question closes no menu");
    await page.getByRole("region", { name: "Plot", exact: true }).waitFor();
    await until(page, () => Number.isFinite(visum.read("arm", "Actual Angle 2")));
    assert.equal(await page.evaluate(() => document.querySelector(".part .holder").textContent), "free", "leases end");
  });
  assert.deepEqual(other.faults, []);
});

// Files of an installation: a scene that cannot be read, and scenarios that pass, fail, and go on.
function writeInstallation(files) {
  const models = join(files, "models");
  for (const folder of ["scenes", "scenarios"]) mkdirSync(join(models, folder), { recursive: true });
  writeFileSync(join(models, "scenes/broken.yaml"), "visum: 1\nbodies:\n  - {name: box, mass: heavy}\n");
  const scenario = (name, text) => writeFileSync(join(models, "scenarios", `${name}.yaml`), `visum_scenario: 1\nname: ${name}\nscene: ${join(source, "models/scenes/amtec_arm.yaml")}\n${text}`);
  const upright = "{name: never tips over, that: {tilt: {body: box}, below: 1}, when: always}";
  const there = "{name: is there soon, that: {position: {body: box, axis: z}, above: 0.1}, when: eventually}";
  const flies = "{name: flies, that: {position: {body: box, axis: z}, above: 9}}";
  scenario("good", `until: {at_s: 0.4}\nchecks: [${upright}, ${there}]\n`);
  scenario("bad", `until: {at_s: 0.4}\nchecks: [${flies}, ${there}]\n`);
  scenario("endless", `max_sim_s: 100000\nuntil: {at_s: 90000}\nclock: realtime\nchecks: [${there}, ${flies}]\n`);
  return ["--models", models];
}

pageTest("scenarios are run on the page: their checks live, their verdict in words and colour", async (page, claim, daemon) => {
  const menu = await openMenu(page);
  const course = menu.getByRole("group", { name: "The scenario that runs or ran last" });
  const list = menu.getByRole("list", { name: "scenarios", exact: true });
  const checks = course.getByRole("list", { name: "Checks" }).getByRole("listitem");
  const start = (name) => list.getByRole("button", { name: `Start ${name}`, exact: true }).click();
  const verdict = (words, tone) => until(page, ([words, tone]) => {
    const shown = document.querySelector(".verdict");
    return shown.textContent === words && shown.dataset.tone === tone;
  }, [words, tone]);
  await claim("a refused scene says where and why, and the world goes on", async () => {
    await load(page, "broken");
    const refusal = scenes(page).getByRole("alert").filter({ hasText: "broken.yaml" });
    await refusal.waitFor();
    assert.match(await refusal.textContent(), /broken\.yaml:3/);
    assert.equal(await page.title(), "amtec_arm · Visum");
  });
  await claim("one that passes", async () => {
    assert.deepEqual(await shownNames(list), ["bad", "endless", "good"]);
    assert.ok(await course.isHidden());
    await start("good");
    await verdict("passed", "good");
    assert.deepEqual((await checks.locator(".check-mark").allTextContents()), ["✓ passed", "✓ passed"]);
    assert.match(await course.textContent(), /^good/);
  });
  await claim("one that fails, with its checks", async () => {
    await start("bad");
    await verdict("failed", "bad");
    assert.match(await checks.filter({ hasText: "flies" }).textContent(), /^✗ failed/);
    assert.match(await checks.filter({ hasText: "is there soon" }).textContent(), /^✓ passed/);
  });
  await claim("one that is stopped is invalid; meanwhile a check has passed, and none can be started", async () => {
    await start("endless");
    await verdict("runs", "busy");
    await checks.filter({ hasText: "is there soon" }).waitFor();
    assert.equal(await checks.count(), 1);
    assert.ok(await list.getByRole("button", { name: "Start good" }).isDisabled());
    await course.getByRole("button", { name: "Stop the scenario" }).click();
    await verdict("invalid", "warn");
    assert.ok(await list.getByRole("button", { name: "Start good" }).isEnabled());
  });
  await claim("another client's is shown as well; its end is told with the menu closed", async () => {
    visum(daemon, "scenario", "start", "good");
    await verdict("passed", "good");
    await page.keyboard.press("Escape");
    // It goes by itself.
    const told = page.locator(".toast.error").getByText("The scenario 'bad' has failed").waitFor();
    visum(daemon, "scenario", "start", "bad");
    await told;
  });
  await claim("an observer sees both lists, and why nothing can be done", async () => {
    await page.getByRole("combobox", { name: "Role", exact: true }).selectOption("Observer");
    await live(page);
    await openMenu(page);
    await menu.getByText("Only an administrator changes the world.").waitFor();
    await verdict("failed", "bad");
    await until(page, () => [...document.querySelectorAll(".names button")].length === 4 && [...document.querySelectorAll(".names button")].every(({ disabled }) => disabled));
    assert.equal(await menu.getByRole("button", { name: "Break it" }).isVisible(), false);
  });
  await claim("with nothing that an accessibility checker finds", async () => {
    for (const colorScheme of ["light", "dark"]) {
      await page.emulateMedia({ colorScheme });
      assert.deepEqual(await axeFindings(page), []);
    }
  });
}, { serve: () => Keeping.start(writeInstallation), ...flat });

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
