// Stereo: each eye's picture of a red disc on the table, against similar triangles.
import assert from "node:assert/strict";
import { button, drawn, isRed, look, pageTest, viewBox } from "./harness.mjs";
import { middleOf, pixels } from "./picture.mjs";

const kDisc = [0.5, -0.2, 0.201]; // the middle of its upper face: models/scenes/amtec_arm.yaml
const near = (a, b, tolerance) => assert.ok(Math.abs(a - b) < tolerance, `${a} is not ${b}`);
const minus = (a, b) => a.map((value, i) => value - b[i]);
const dot = (a, b) => a.reduce((sum, value, i) => sum + value * b[i], 0);

// The distance of the disc in front of the viewer, m.
async function depth(page) {
  const { position, target } = await page.evaluate(() => visum.camera());
  const ahead = minus(target, position);
  return dot(minus(kDisc, position), ahead) / Math.hypot(...ahead);
}

// How many pixels further right the disc is for the left eye, in a window of `width` pixels that shows the
// whole width of the view. With eyes e apart, the screen at s and the disc at z, it is e (s/z - 1) on a
// screen 2 s tan(fov/2) a wide.
async function disparity(page, { eyes, screen }, width) {
  const { fov } = await page.evaluate(() => visum.camera());
  const box = await viewBox(page);
  const screenWidth = 2 * screen * Math.tan((fov * Math.PI) / 360) * (box.width / box.height);
  return ((eyes * (screen / (await depth(page)) - 1)) / screenWidth) * width;
}

async function useStereo(page, mode, { eyes, screen, swapped = false }) {
  await button(page, "Stereo").click();
  await page.getByRole("combobox", { name: "Stereo mode" }).selectOption(mode);
  await page.getByLabel("Eyes apart, m").fill(String(eyes));
  await page.getByLabel("Screen at, m").fill(String(screen));
  await page.getByLabel("Swap the eyes").setChecked(swapped);
  await page.keyboard.press("Escape");
  await drawn(page);
  return pixels(page, await viewBox(page));
}

// The place of the disc in the left and in the right picture, each from its own corner.
function inHalves(image, beside) {
  const [width, height] = [image.width >> 1, image.height >> 1];
  const halves = beside ? [{ to: width }, { from: width }] : [{ bottom: height }, { top: height }];
  const found = halves.map((half) => middleOf(image, isRed, half));
  assert.ok(found.every(({ count }) => count > 100), JSON.stringify(found));
  return found;
}

pageTest("stereo: each eye sees what it must", async (page, claim) => {
  await button(page, "Pause").click();
  await look(page, "Table");
  const wide = { eyes: 0.1, screen: 2 };
  const expected = await disparity(page, wide, (await viewBox(page)).width);
  assert.ok(expected > 30, "enough to be measured");

  await claim("side by side: half as wide, the disparity of similar triangles", async () => {
    const [left, right] = inHalves(await useStereo(page, "side-by-side", wide), true);
    near(left.x - right.x, expected / 2, 0.7);
    near(left.y, right.y, 0.3);
  });
  await claim("top and bottom, the left eye above: the same in whole width", async () => {
    const [left, right] = inHalves(await useStereo(page, "top-bottom", wide), false);
    near(left.x - right.x, expected, 0.7);
    near(left.y, right.y, 1.2); // an odd height is halved
  });
  await claim("left for right", async () => {
    const [left, right] = inHalves(await useStereo(page, "top-bottom", { ...wide, swapped: true }), false);
    near(left.x - right.x, -expected, 0.7);
  });
  await claim("nothing is shifted in the plane of the screen", async () => {
    const [left, right] = inHalves(await useStereo(page, "top-bottom", { ...wide, screen: (await depth(page)).toFixed(4) }), false);
    near(left.x, right.x, 0.3);
  });
  await claim("beyond the screen it is shifted the other way", async () => {
    const close = { eyes: 0.1, screen: 0.5 };
    const [left, right] = inHalves(await useStereo(page, "top-bottom", close), false);
    near(left.x - right.x, await disparity(page, close, (await viewBox(page)).width), 0.7);
    assert.ok(left.x < right.x);
  });
  await claim("anaglyph: the disc is dark in red for the left eye, in green and blue for the right", async () => {
    const plain = inMiddle(await useStereo(page, "off", wide));
    const image = await useStereo(page, "anaglyph", { ...wide, eyes: 0.3 }); // so that the two do not overlap
    const [middle, reach] = [Math.round(plain.x), Math.round(3 * expected)];
    const rows = { top: Math.round(plain.y) - 20, bottom: Math.round(plain.y) + 20 };
    const left = middleOf(image, (r, g) => r < 0.9 * g, { ...rows, from: middle, to: middle + reach });
    const right = middleOf(image, isRed, { ...rows, from: middle - reach, to: middle });
    assert.ok(left.count > 100 && right.count > 100, JSON.stringify([left, right]));
    near(left.x, 1.5 * expected, 1.5);
    near(right.x - reach, -1.5 * expected, 1.5);
  });
  await claim("a click meets what is under the pointer in either half", async () => {
    const image = await useStereo(page, "side-by-side", wide);
    const [left, right] = inHalves(image, true);
    const { x, y } = await viewBox(page);
    for (const [from, at] of [[0, left], [image.width >> 1, right]]) {
      await page.mouse.click(x + from + at.x, y + at.y);
      const card = page.getByRole("region", { name: "Selected body" });
      assert.equal(await card.getByRole("heading").textContent(), "target");
      await card.getByRole("button", { name: "Close" }).click();
    }
  });
});

function inMiddle(image) {
  const found = middleOf(image, isRed);
  assert.ok(found.count > 100, JSON.stringify(found));
  return found;
}
