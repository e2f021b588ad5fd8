// The tests of this folder share one browser. Each test has its own daemon and its own page, and fails if
// the page has done something wrong by the end (`page.faults`).
import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { readFileSync } from "node:fs";
import { drawn, twoFrames } from "./picture.mjs";
import { Daemon, launch, openPage, require, until } from "./programs.mjs";

export { drawn, twoFrames, until };

export let browser;
before(async () => {
  browser = await launch();
});
after(() => browser?.close());

const kLongestMs = 300_000; // a guard against hanging for ever, not a measure

// There is no second try: it would hide a race. A wait in a test is for a condition, and never for time.
export function browserTest(name, run) {
  test(name, { timeout: kLongestMs }, run);
}

// Calls `run(page, claim, daemon)`. claim(name, body) runs a part of the test; its name stands in the error
// if it fails. `serve` starts the program that serves the page.
export function pageTest(name, run, { daemon: words = [], serve = () => Daemon.start(...words), ...options } = {}) {
  browserTest(name, async (t) => {
    const daemon = await serve();
    try {
      const page = await openPage(browser, daemon, options);
      await run(page, (words, body) => claim(t, words, body), daemon);
      assert.deepEqual(page.faults, []);
    } finally {
      await closePages();
      await daemon.stop();
    }
  });
}

// An option of a page: the browser draws no 3D. What is not about the view is tested so, because software
// draws slowly.
export const flat = {
  before: () => {
    const get = HTMLCanvasElement.prototype.getContext;
    HTMLCanvasElement.prototype.getContext = function (kind, ...more) {
      return kind.startsWith("webgl") ? null : get.call(this, kind, ...more);
    };
  },
};

async function claim(t, words, body) {
  try {
    await body();
    t.diagnostic(`ok: ${words}`);
  } catch (error) {
    throw new Error(`${words}: ${error.message}`, { cause: error });
  }
}

export const closePages = () => Promise.all(browser.contexts().map((context) => context.close()));
export const button = (page, name) => page.getByRole("button", { name, exact: true });
export const control = (page) => page.evaluate(() => visum.acquire("arm"));
export const viewBox = (page) => page.locator(".view canvas[data-engine]").boundingBox();
export async function look(page, name) {
  await page.getByRole("combobox", { name: "Viewpoint" }).selectOption(name);
  await settled(page, "table"); // the view travels there
}
export async function overlay(page, name, on) {
  const box = page.getByLabel(name, { exact: true });
  if (!(await box.isVisible())) await button(page, "Overlays").click();
  await box.setChecked(on);
  await page.keyboard.press("Escape");
  await drawn(page);
}
// Waits until a body stays where it is on the screen: at the same place in several looks, with two frames of
// the display between them. On a busy machine no frame may come between two looks, and a body that travels
// would seem to stand.
export async function settled(page, name) {
  const kLooks = 5;
  let before = "";
  for (let same = 0; same < kLooks; ) {
    await twoFrames(page);
    const now = JSON.stringify(await body(page, name));
    same = now === before ? same + 1 : 0;
    before = now;
  }
}
// Where a point of a body is on the screen.
export const body = (page, name, point) => page.evaluate(([name, point]) => visum.project(name, point), [name, point]);
export const isRed = (r, g, b) => r > 120 && r > 3 * g && r > 3 * b; // and not the arm's orange
export const isBlue = (r, g, b) => b > 80 && b > 1.5 * g && b > 3 * r;
// An accessibility checker looks at the page as it is now and finds: a rule, and the elements that break it.
export async function axeFindings(page) {
  await page.evaluate(readFileSync(require.resolve("axe-core/axe.min.js"), "utf8"));
  const { violations } = await page.evaluate(() => axe.run({ resultTypes: ["violations"] }));
  return violations.map(({ id, nodes }) => `${id}: ${nodes.map(({ target }) => target).join(" ")}`);
}
