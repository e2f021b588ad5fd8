// What the tests of this folder share: one browser, and for each test a daemon and a page of its own, which must have
// done nothing wrong in the end.
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { Daemon, launch, openPage } from "./programs.mjs";

export let browser;
before(async () => {
  browser = await launch();
});
after(() => browser?.close());

// `run(page, claim, daemon)`; claim(name, body): a part of the test that stands on its own.
export function pageTest(name, run, { daemon: words = [], ...options } = {}) {
  test(name, async (t) => {
    const daemon = await Daemon.start(...words);
    try {
      const page = await openPage(browser, daemon, options);
      await run(page, (claim, body) => t.test(claim, body), daemon);
      assert.deepEqual(page.faults, []);
    } finally {
      await closePages();
      await daemon.stop();
    }
  });
}

export const closePages = () => Promise.all(browser.contexts().map((context) => context.close()));
// Waits for what must come; the time-out is a guard against hanging for ever, not a measure.
export const until = (page, condition, argument) => page.waitForFunction(condition, argument, { timeout: 120_000, polling: 100 });
export const button = (page, name) => page.getByRole("button", { name, exact: true });
export const control = (page) => page.evaluate(() => visum.acquire("arm"));
export const viewBox = (page) => page.locator(".view canvas").boundingBox();
export const look = (page, name) => page.getByRole("combobox", { name: "Viewpoint" }).selectOption(name);
// Where a point of a body is on the screen.
export const body = (page, name, point) => page.evaluate(([name, point]) => visum.project(name, point), [name, point]);
export const isRed = (r, g, b) => r > 120 && r > 3 * g && r > 3 * b; // and not the arm's orange
export const isBlue = (r, g, b) => b > 80 && b > 1.5 * g && b > 3 * r;

const twoFrames = (page) => page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));

// Until the view is drawn as it stays, with every pixel (a slow machine leaves some out while things move), and is on the
// screen: reading a pixel waits for all that was drawn before.
export async function drawn(page) {
  await twoFrames(page);
  await until(page, () => {
    const canvas = document.querySelector(".view canvas");
    return canvas.width === Math.floor(canvas.clientWidth * devicePixelRatio);
  });
  await page.evaluate(() => {
    const gl = document.querySelector(".view canvas").getContext("webgl2");
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
  });
  await twoFrames(page);
}
