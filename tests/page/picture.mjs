// Reads pixels of the screen. The browser itself decodes them.
import { until } from "./programs.mjs";

// { width, height, data } of a part of the page: RGBA, row by row.
export async function pixels(page, clip) {
  const png = (await page.screenshot({ clip })).toString("base64");
  const { width, height, data } = await page.evaluate(async (text) => {
    const bytes = Uint8Array.from(atob(text), (c) => c.charCodeAt(0));
    const bitmap = await createImageBitmap(new Blob([bytes], { type: "image/png" }));
    const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext("2d");
    context.drawImage(bitmap, 0, 0);
    const { width, height, data } = context.getImageData(0, 0, bitmap.width, bitmap.height);
    let packed = "";
    for (let i = 0; i < data.length; i += 0x8000) packed += String.fromCharCode(...data.subarray(i, i + 0x8000));
    return { width, height, data: btoa(packed) };
  }, png);
  return { width, height, data: Buffer.from(data, "base64") };
}

// [red, green, blue] at a place of the page.
export async function colourAt(page, { x, y }) {
  const { data } = await pixels(page, { x: Math.round(x), y: Math.round(y), width: 1, height: 1 });
  return [...data.subarray(0, 3)];
}

// The middle and the number of the pixels for which `is` returns true, within [from, to) by [top, bottom),
// counted from there.
export function middleOf({ width, height, data }, is, { from = 0, to = width, top = 0, bottom = height } = {}) {
  let x = 0, y = 0, count = 0;
  for (let row = top; row < bottom; ++row)
    for (let column = from; column < to; ++column) {
      const at = 4 * (row * width + column);
      if (!is(data[at], data[at + 1], data[at + 2])) continue;
      x += column - from;
      y += row - top;
      count += 1;
    }
  return { x: x / count, y: y / count, count };
}

// Returns a test for a colour, within a tolerance.
export const like = (wanted, tolerance = 8) => (...seen) => wanted.every((value, i) => Math.abs(seen[i] - value) <= tolerance);

// The pixels of a colour that are at most `reach` pixels from a place of the view.
export async function around(page, { x, y }, reach, is) {
  const view = await page.locator(".view canvas[data-engine]").boundingBox();
  const [left, top] = [Math.max(view.x, Math.round(x) - reach), Math.max(view.y, Math.round(y) - reach)];
  return middleOf(await pixels(page, { x: left, y: top, width: 2 * reach + 1, height: 2 * reach + 1 }), is);
}

export const twoFrames = (page) => page.evaluate(() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));

// Waits until the view is drawn in its final state, with every pixel (a slow machine leaves some out while
// things move), and is on the screen. Reading a pixel waits for all that was drawn before.
export async function drawn(page) {
  await twoFrames(page);
  await until(page, () => {
    const canvas = document.querySelector(".view canvas[data-engine]");
    return canvas.width === Math.floor(canvas.clientWidth * devicePixelRatio);
  });
  await page.evaluate(() => {
    const gl = document.querySelector(".view canvas[data-engine]").getContext("webgl2");
    gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(4));
  });
  await twoFrames(page);
}
