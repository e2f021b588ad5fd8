// Browse: the tree with its search, editors, hold, parameters, blackboards, the cycle's profile.
import assert from "node:assert/strict";
import { button, control, pageTest, until } from "./harness.mjs";

pageTest("browse: everything of a part is found, read and set", async (page, claim) => {
  const shown = () => page.locator(".port:visible").evaluateAll((rows) => rows.map((row) => row.dataset.port));
  const summary = (name) => page.locator("summary", { hasText: name });
  await claim("search shows what has all words, and opens where it is", async () => {
    const search = page.getByRole("searchbox", { name: "Search ports" });
    await search.fill("speed 3");
    assert.deepEqual(await shown(), ["Maximum Speed 3", "Actual Speed 3"]);
    await search.fill("no such thing");
    assert.ok(await page.getByText("No port matches.").isVisible());
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
    assert.deepEqual(kinds, ["checkbox", "number", "select-one"]);
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
