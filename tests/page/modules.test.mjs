// The graph of a controller's modules, with the paper's figure 6: three parts in three processes.
import assert from "node:assert/strict";
import { execFileSync, spawn } from "node:child_process";
import { mkdtempSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { flat, pageTest, until } from "./harness.mjs";
import { bin } from "./programs.mjs";

function start(kind, lower, ...more) {
  return spawn(join(bin, `visum-mca-${kind}`), ["--lower", lower, "--port", "0", ...more], { stdio: "ignore" });
}

pageTest("the modules of a controller are a graph whose groups open", async (page, claim, daemon) => {
  const server = `127.0.0.1:${daemon.port}`;
  const visum = (...words) => execFileSync(join(bin, "visum"), [...words, "--connect", server], { encoding: "utf8" });
  const folder = mkdtempSync(join(tmpdir(), "visum-modules-"));
  const waits = join(folder, "waits.yaml"); // at its first pose, as long as the page is looked at
  writeFileSync(waits, "Sequence: {Pause: 60}\n");
  const parts = [start("hardware", `arm@${server}`), start("motion", `hardware@${server}`), start("task", `motion@${server}`, "--configfile", waits)];
  const node = (name) => page.locator(".modules-node", { hasText: name });
  try {
    await page.getByRole("tab", { name: "Modules" }).click();
    await claim("parts stand above what they command, down to the arm", async () => {
      for (const name of ["task", "motion", "hardware", "hardware part"]) await node(name).first().waitFor();
      const tops = await page.locator(".modules-node").evaluateAll((nodes) =>
        Object.fromEntries(nodes.map((one) => [one.querySelector(".modules-name").textContent, one.offsetTop])));
      assert.ok(tops.task < tops.motion && tops.motion < tops.hardware && tops.hardware < tops.arm, JSON.stringify(tops));
    });
    await claim("cycle times are shown by module", async () => {
      await until(page, () => /control .*s · sense .*s · every 5\.?0* ms/.test(document.querySelector('.modules-node[title="Open motion"]')?.textContent ?? ""));
    });
    await claim("an edge lists the values that pass", async () => {
      await page.getByTitle("Control from hardware to arm").click();
      await page.getByRole("row", { name: /Desired Angle 7/ }).waitFor();
      assert.equal(await page.locator(".modules-values tr").count(), 14);
    });
    await claim("a group opens to its modules, and the trail leads back", async () => {
      await node("motion").click();
      await node("Arm").click();
      await node("Trajectory").waitFor();
      await page.getByTitle("Sense from Arm/Supervisor to Arm/Trajectory").waitFor();
      assert.equal(await page.locator(".modules-trail").textContent(), "All partsmotionArm");
    });
    await claim("a held sensor input is marked", async () => {
      visum("modules", "motion", "--hold", "Arm/Supervisor/Part State=3");
      await page.locator(".modules-node[data-held]", { hasText: "holds Part State" }).waitFor();
    });
    await claim("modules go with their programs", async () => {
      for (const part of parts) part.kill("SIGKILL");
      await page.getByText("No controller has announced modules.").waitFor();
    });
  } finally {
    for (const part of parts) part.kill("SIGKILL");
    rmSync(folder, { recursive: true });
  }
}, flat);
