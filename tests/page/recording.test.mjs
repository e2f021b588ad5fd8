// A recording on the page. The page shows what was recorded at the slider's time, tells the first difference,
// and lets nothing be changed.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { forge } from "./forge.mjs";
import { body, browser, button, drawn, look, pageTest, until } from "./harness.mjs";
import { linkPositions, readArm } from "./kinematics.mjs";
import { bin, Daemon, openPage } from "./programs.mjs";

const kTarget = 0.62, kOther = 0.21;
const kJoints = [1, 2, 3, 4, 5, 6, 7];

// A recording of an arm that a page has moved, shown by visumd. `change` alters the file before.
class Replayed extends Daemon {
  static async start(change = (file) => file) {
    const replayed = new Replayed();
    replayed.folder = mkdtempSync(join(tmpdir(), "visum-replay-"));
    const file = join(replayed.folder, "run.mcap");
    const live = await Daemon.start("--record", file);
    const page = await openPage(browser, live);
    await page.evaluate(async (target) => {
      await visum.acquire("arm");
      await visum.write("arm", "Desired Angle 1", target);
    }, kTarget);
    execFileSync(join(bin, "visum"), ["fault", "arm", "encoder_noise", "joint=7", "deviation=0.0001", "--connect", `127.0.0.1:${live.port}`]);
    await until(page, (target) => visum.read("arm", "Actual Angle 1") > target - 0.01, kTarget);
    await page.context().close();
    await live.stop();
    await replayed.spawn("visumd", ["replay", change(file), "--view", "--http", "0", "--json"]);
    return replayed;
  }
  async stop() {
    await super.stop();
    rmSync(this.folder, { recursive: true });
  }
}

function forged(file) {
  forge(file, `${file}.forged`, kTarget, kOther);
  return `${file}.forged`;
}

const slider = (page) => page.getByRole("slider", { name: "Time of the recording" });
const length = async (page) => Number(await slider(page).getAttribute("max"));
const found = (page) => page.locator(".timeline-words").textContent();

// Drags the slider as by hand, and resolves when the world is there. The recording has one era, so its
// simulated time is its number of ticks.
async function dragTo(page, position) {
  await slider(page).fill(String(position));
  await until(page, (seconds) => [visum.simTime(), visum.shownTime()].every((time) => Math.abs(time - seconds) < 1e-9), position / 1000);
  await drawn(page);
}

pageTest("a recording is moved through by its slider", async (page, claim) => {
  const ticks = await length(page);
  assert.ok(ticks > 1000, `${ticks} ticks`);

  await claim("it says what it is, and nothing in it can be changed", async () => {
    assert.equal(await page.locator(".reality").textContent(), "Recording");
    assert.match(await page.locator(".connection").textContent(), /^Recorded/);
    assert.ok(await button(page, "Take control").first().isDisabled());
    assert.ok(await button(page, "Reset the world").isDisabled());
    const refusal = await page.evaluate(() => visum.acquire("arm").then(() => "none", (error) => error.message));
    assert.match(refusal, /this is a recording/);
    assert.equal(await page.getByRole("region", { name: "Part recording" }).count(), 0, "what steers is no part of the world");
  });

  await claim("wherever it is dragged, ports and poses are of that tick", async () => {
    await look(page, "Above");
    const seen = [];
    for (const position of [ticks, 0, Math.round(ticks / 2), 1003]) {
      await dragTo(page, position);
      const angles = await page.evaluate((joints) => joints.map((i) => visum.read("arm", `Actual Angle ${i}`)), kJoints);
      seen.push(angles[0]);
      const hand = linkPositions(readArm(), Object.fromEntries(angles.map((angle, i) => [`joint_${i + 1}`, angle]))).get("link_7");
      const [shown, expected] = [await body(page, "arm/link_7"), await body(page, "floor", hand)];
      assert.ok(Math.hypot(shown.x - expected.x, shown.y - expected.y) < 2, JSON.stringify([position, shown, expected]));
    }
    assert.ok(seen[0] > kTarget - 0.02, `at the end ${seen[0]}`);
    assert.ok(Math.abs(seen[1]) < 0.01, `at the beginning ${seen[1]}`);
  });

  await claim("a plot shows what was before that, tick by tick", async () => {
    const lines = async () => {
      const [download] = await Promise.all([page.waitForEvent("download"), button(page, "Export as CSV").click()]);
      return readFileSync(await download.path(), "utf8").trim().split("\n").slice(1).map((line) => line.split(",").map(Number));
    };
    await button(page, "Plot Actual Angle 1").click();
    for (const position of [ticks, 1500]) {
      const filled = page.waitForResponse((response) => response.url().includes(`/recording/ports/0/${position}/`));
      await dragTo(page, position);
      await (await filled).finished();
      const angle = await page.evaluate(() => visum.read("arm", "Actual Angle 1"));
      let rows = await lines();
      // The samples are in the plot a moment later
      while (rows.length !== Math.min(position, 10_000)) rows = await lines();
      assert.deepEqual(rows.map(([time]) => Math.round(1000 * time)), rows.map((_, i) => position - rows.length + 1 + i));
      assert.ok(Math.abs(rows.at(-1)[1] - angle) < 1e-6, `${rows.at(-1)} and ${angle}`);
    }
  });

  await claim("its log tells what happened, and leads there", async () => {
    await button(page, "Log").click();
    const line = page.getByRole("listbox", { name: "What happened" }).getByRole("option").filter({ hasText: "encoder_noise" });
    await line.click();
    const [minutes, seconds] = (await line.locator(".log-time").textContent()).split(":").map(Number);
    await until(page, (time) => Math.abs(visum.simTime() - time) < 1e-9, 60 * minutes + seconds);
    assert.equal(await page.locator('.mark[title*="encoder_noise"]').count(), 1, "its mark");
  });

  await claim("it plays to its end, and begins anew", async () => {
    await dragTo(page, ticks - 300);
    await button(page, "Run").click();
    await until(page, (end) => visum.simTime() === end / 1000, ticks);
    await button(page, "Run").click();
    await until(page, (end) => visum.simTime() < end / 1000, ticks);
    await button(page, "Pause").click();
  });

  await claim("all of it is compared meanwhile", async () => {
    await until(page, () => /^The same bits in all/.test(document.querySelector(".timeline-words").textContent));
    assert.ok(await page.locator(".difference-mark").isHidden());
  });
}, { serve: () => Replayed.start() });

pageTest("the first difference is marked, and told in words", async (page, claim) => {
  await until(page, () => /^First difference/.test(document.querySelector(".timeline-words").textContent));

  await claim("with its tick, its part and both values", async () => {
    const words = await found(page);
    const tick = Number(words.match(/^First difference at tick ([\d,]+): /)[1].replaceAll(",", ""));
    const hasHash = tick % 50 === 1 || tick % 1000 === 0;
    assert.match(words, new RegExp(`^[^:]*: ${hasHash ? "the state is another one" : "ports are others"}\\. arm, `));
    assert.match(words, /recorded -?[\d.e-]+, replayed -?[\d.e-]+/);
    assert.match(words, new RegExp(`Desired Angle 1: recorded ${kTarget}\\d*, replayed ${kOther}`));
  });

  await claim("the mark stands at its tick, and a button leads there", async () => {
    const tick = Number(/at tick ([\d,]+)/.exec(await found(page))[1].replaceAll(",", ""));
    const [track, mark] = [await slider(page).boundingBox(), await page.locator(".difference-mark").boundingBox()];
    const expected = track.x + 8 + (tick / (await length(page))) * (track.width - 16);
    assert.ok(Math.abs(mark.x + mark.width / 2 - expected) < 2, JSON.stringify([track, mark, expected]));
    await button(page, "Go there").click();
    await until(page, (seconds) => Math.abs(visum.simTime() - seconds) < 1e-9, tick / 1000);
    assert.equal(await page.evaluate(() => visum.read("arm", "Desired Angle 1")), kTarget, "ports are the recorded ones");
  });
}, { serve: () => Replayed.start(forged) });
