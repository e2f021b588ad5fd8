// Browse: the tree with its search, editors, hold, parameters, blackboards, the cycle's profile.
import assert from "node:assert/strict";
import { join } from "node:path";
import { button, control, pageTest, twoFrames, until } from "./harness.mjs";
import { source } from "./programs.mjs";

pageTest("browse: everything of a part is found, read and set", async (page, claim) => {
  const shown = () => page.locator(".port:visible").evaluateAll((rows) => rows.map((row) => row.dataset.port));
  const summary = (name) => page.locator("summary", { hasText: name });
  await claim("search shows what has all words, and opens where it is", async () => {
    const search = page.getByRole("searchbox", { name: "Search ports and parameters" });
    await search.fill("speed 3");
    assert.deepEqual(await shown(), ["Maximum Speed 3", "Actual Speed 3"]);
    await search.fill("no such thing");
    assert.ok(await page.getByText("No port and no parameter matches.").isVisible());
    await search.fill("");
    assert.ok((await shown()).length > 10);
  });
  await button(page, "Take control").click();
  await claim("a number is typed, a switch is switched, a counter counts", async () => {
    const number = page.getByRole("spinbutton", { name: "Desired Angle 1 in rad" });
    await number.fill("0.125");
    await number.press("Enter");
    await until(page, () => visum.read("arm", "Desired Angle 1") === 0.125);
    await page.getByRole("switch", { name: "Execution Enable" }).uncheck();
    await until(page, () => visum.read("arm", "Execution Enable") === 0);
    await page.getByRole("switch", { name: "Execution Enable" }).check();
    const count = await page.evaluate(() => visum.read("arm", "Reset"));
    await button(page, "Trigger Reset").click();
    await until(page, (value) => visum.read("arm", "Reset") === value + 1, count);
  });
  await claim("beyond its range a number is refused, in the server's words", async () => {
    await assert.rejects(page.evaluate(() => visum.write("arm", "Desired Angle 1", 100)), /Desired Angle 1/);
  });
  await claim("a held value keeps, until it is let go", async () => {
    await button(page, "Hold Desired Angle 1").click();
    await assert.rejects(page.evaluate(() => visum.write("arm", "Desired Angle 1", 0.2)), /is held at 0\.125/);
    await button(page, "Hold Desired Angle 1").click();
    await page.evaluate(() => visum.write("arm", "Desired Angle 1", 0.2));
  });
  await claim("parameters have editors of their types", async () => {
    await summary("Parameters").click();
    const editors = page.locator(".parameter");
    await editors.first().waitFor();
    const kinds = await editors.evaluateAll((rows) => [...new Set(rows.map((row) => row.querySelector("select, input").type))].sort());
    assert.deepEqual(kinds, ["checkbox", "number", "select-one", "text"]);
    const choice = editors.locator("select").first();
    await choice.selectOption("hold");
    await until(page, () => document.querySelector(".parameter select").value === "hold");
  });
  await claim("a blackboard of text is shown as text", async () => {
    await summary("Blackboards").click();
    await until(page, () => /kind: amtec_arm\nmodule \d+: /.test(document.querySelector(".blackboard pre")?.textContent ?? ""));
  });
  await claim("the profile of the cycle, by phase", async () => {
    await summary("Cycle").click();
    await until(page, () => document.querySelectorAll(".profile tbody tr").length >= 5);
    const names = await page.locator(".profile tbody th").allTextContents();
    for (const name of ["sense", "act", "step", "publish"]) assert.ok(names.includes(name), names.join());
  });
});

pageTest("a panel is edited, saved, loaded and shared", async (page, claim, daemon) => {
  const widget = (name) => page.locator(".panel-grid").getByRole("group", { name, exact: true });
  await button(page, "Edit the panel").click();
  await claim("a widget is added, bound to a port, and moved by keys", async () => {
    await page.getByRole("combobox", { name: "Kind of widget" }).selectOption({ label: "LED" });
    await button(page, "Add").click();
    const settings = page.locator(".panel-settings");
    await settings.getByLabel("Label").fill("Running");
    await settings.getByLabel("Label").press("Enter");
    await settings.getByLabel("Port").selectOption({ label: "arm · Execution Enable" });
    await widget("Running").focus();
    await page.keyboard.press("ArrowRight");
    await page.keyboard.press("Shift+ArrowDown");
    assert.match(await widget("Running").getAttribute("style"), /2 \/ span 3/);
    await until(page, () => [...document.querySelectorAll(".led-word")].some((word) => word.textContent === "on"));
  });
  await claim("a port dropped on it becomes a control", async () => {
    await page.locator('.port[data-port="Desired Angle 3"]').dragTo(page.locator(".panel-grid"), { targetPosition: { x: 20, y: 20 } });
    await widget("Desired Angle 3").waitFor();
  });
  const [saved] = await Promise.all([page.waitForEvent("download"), button(page, "Save the panel to a file").click()]);
  const file = await saved.path();
  const widgets = () => page.locator(".panel-grid > .widget").count();
  const count = await widgets();
  await claim("what was saved is loaded again", async () => {
    await page.getByRole("combobox", { name: "Panel", exact: true }).selectOption({ label: "Empty panel" });
    assert.equal(await widgets(), 0);
    const [chooser] = await Promise.all([page.waitForEvent("filechooser"), button(page, "Load a panel from a file").click()]);
    await chooser.setFiles({ name: "a.panel.json", mimeType: "application/json", buffer: (await import("node:fs")).readFileSync(file) });
    await widget("Running").waitFor();
    assert.equal(await widgets(), count);
  });
  await claim("a bad file is refused where it is bad", async () => {
    const [chooser] = await Promise.all([page.waitForEvent("filechooser"), button(page, "Load a panel from a file").click()]);
    await chooser.setFiles({ name: "b.json", mimeType: "application/json", buffer: Buffer.from('{"visum_panel": 1, "name": "x", "widgets": [7]}') });
    await page.getByText("widgets[0]: must be a map").waitFor();
    assert.equal(await widgets(), count);
  });
  await claim("a link holds the panel", async () => {
    await button(page, "Copy a link to this panel").click();
    await until(page, () => location.hash.startsWith("#panel="));
    const other = await page.context().newPage();
    await other.goto(`${daemon.url}${await page.evaluate(() => location.hash)}`);
    await other.locator(".panel-grid").getByRole("group", { name: "Running", exact: true }).waitFor();
    await other.close();
  });
  await claim("where the browser has no clipboard, it is not said to be there", async () => {
    await page.evaluate(() => Object.defineProperty(navigator, "clipboard", { value: undefined }));
    await button(page, "Copy a link to this panel").click();
    await page.getByText("The address now holds this panel; copy it from there").waitFor();
  });
});

pageTest("plots: full rate, zoom, cursor, phase, export", async (page, claim) => {
  const passes = async (seconds) => {
    const from = await page.evaluate(() => visum.simTime());
    await until(page, (time) => visum.simTime() > time, from + seconds);
  };
  const { readFileSync } = await import("node:fs");
  await button(page, "Plot Desired Angle 1").click();
  await button(page, "Plot Actual Angle 1").click();
  await control(page);
  await page.evaluate(() => visum.write("arm", "Desired Angle 1", 0.3));
  await passes(2);
  const exported = async () => {
    const [download] = await Promise.all([page.waitForEvent("download"), button(page, "Export as CSV").click()]);
    return readFileSync(await download.path(), "utf8").trim().split("\n");
  };
  await claim("a line a tick in the CSV", async () => {
    const lines = await exported();
    assert.match(lines[0], /arm Desired Angle 1 \[rad\].*arm Actual Angle 1 \[rad\]/);
    const times = lines.slice(1).map((line) => Number(line.split(",")[0]));
    const gaps = times.slice(1).map((time, i) => time - times[i]).sort((a, b) => a - b);
    assert.ok(times.length > 500, `${times.length} lines`);
    assert.ok(Math.abs(gaps[gaps.length >> 1] - 0.001) < 1e-6, "a line a tick");
  });
  await claim("a picture", async () => {
    const [picture] = await Promise.all([page.waitForEvent("download"), button(page, "Export as PNG").click()]);
    assert.equal(readFileSync(await picture.path()).subarray(1, 4).toString(), "PNG");
  });
  await claim("the cursor tells values; dragging zooms in, a double click goes on", async () => {
    const over = page.locator(".plot .u-over");
    const { x, y, width, height } = await over.boundingBox();
    const legend = () => page.locator(".plot .u-legend .u-value").allTextContents();
    await page.mouse.move(x + 0.9 * width, y + height / 2);
    // Where samples were lost, the cursor says so; the plot moves on below it.
    await until(page, () => / s,.* rad,.* rad$/.test([...document.querySelectorAll(".plot .u-legend .u-value")].map((cell) => cell.textContent).join()));
    await page.mouse.move(x + 0.8 * width, y + height / 2);
    await page.mouse.down();
    await page.mouse.move(x + 0.95 * width, y + height / 2, { steps: 4 });
    await page.mouse.up();
    // Drawn again, half a second later, it tells the same: only what is zoomed does.
    const told = async () => (await passes(0.5), await twoFrames(page), legend());
    let [shown, next] = [await told(), await told()];
    while (next.join() !== shown.join()) [shown, next] = [next, await told()];
    await page.mouse.dblclick(x + 0.9 * width, y + height / 2);
    await until(page, (text) => document.querySelector(".plot .u-legend .u-value").textContent !== text, shown[0]);
  });
  await claim("the second against the first", async () => {
    await button(page, "Phase").click();
    await until(page, () => {
      const canvas = document.querySelector("canvas.phase");
      const blank = Object.assign(document.createElement("canvas"), { width: canvas.width, height: canvas.height });
      return canvas.width > 0 && canvas.toDataURL() !== blank.toDataURL();
    });
    await button(page, "Phase").click();
  });
  await claim("twenty ports dragged into one plot, which keeps what it has", async () => {
    const first = (await exported())[1].split(",")[0];
    for (const group of ["Desired Angle", "Actual Angle", "Actual Speed"])
      await page.locator(".group > summary", { hasText: group }).first().dragTo(page.locator(".plot").first());
    await until(page, () => document.querySelectorAll(".plot .u-series").length >= 21);
    await passes(0.5);
    assert.equal((await exported())[1].split(",")[0], first);
  });
});

pageTest("a phase plot of two parts names what it shows", async (page) => {
  await page.evaluate(() => {
    const write = CanvasRenderingContext2D.prototype.fillText;
    window.written = new Set();
    CanvasRenderingContext2D.prototype.fillText = function (text, ...place) {
      if (this.canvas.className === "phase") written.add(text);
      return write.call(this, text, ...place);
    };
  });
  for (const [part, port] of [["eye", "Distance"], ["scan", "Nearest Distance"], ["eye", "In Range"]])
    await page.getByRole("region", { name: `Part ${part}` }).getByRole("button", { name: `Plot ${port}`, exact: true }).click();
  const traces = await page.locator(".plot .u-legend .u-label").allTextContents();
  await button(page, "Phase").click();
  await until(page, (names) => names.every((name) => [...written].some((text) => text.startsWith(`${name} [`))), traces.slice(1, 3));
}, { daemon: [join(source, "models/scenes/sensors.yaml")] });
