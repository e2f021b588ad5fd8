// Sensors on the page: rays end where the readings say, and frusta open as the scene declares them.
import assert from "node:assert/strict";
import { join } from "node:path";
import { body, button, drawn, overlay, pageTest, until } from "./harness.mjs";
import { around, like } from "./picture.mjs";
import { source } from "./programs.mjs";

const kRay = [0x56, 0xb4, 0xe9], kFrustum = [0xe6, 0x9f, 0x00];

pageTest("what sensors see is laid over the world", async (page, claim) => {
  // Until all have read something, and the turning eye still looks at the wall.
  await page.getByRole("spinbutton", { name: "Number of ticks" }).fill("400");
  await button(page, "ticks").click();
  await until(page, () => ["eye", "scan", "camera"].every((part) => visum.read(part, "Changed") >= 3));
  await drawn(page);
  const read = (part, port) => page.evaluate(([part, port]) => visum.read(part, port), [part, port]);
  // A thin line is blended with what is behind it: its pixels are only near its colour
  const count = async (name, point, color, tolerance = 40) => (await around(page, await body(page, name, point), 4, like(color, tolerance))).count;

  await claim("rays end at the distance that is read", async () => {
    assert.equal(await read("eye", "In Range"), 1, "it looks at the wall");
    const distance = await read("eye", "Distance");
    const [nearest, angle] = [await read("scan", "Nearest Distance"), await read("scan", "Nearest Angle")];
    const ends = [["table", [distance, 0, 0.1]], ["floor", [nearest * Math.cos(angle), nearest * Math.sin(angle), 0.3]]];
    const seen = async () => Promise.all(ends.map(([name, point]) => count(name, point, kRay)));
    assert.deepEqual(await seen(), [0, 0]);
    await overlay(page, "Sensor rays", true);
    await shown(page, seen);
    const beyond = await count("table", [distance + 0.5, 0, 0.1], kRay);
    assert.equal(beyond, 0, "the ray ends there");
    await overlay(page, "Sensor rays", false);
    assert.deepEqual(await seen(), [0, 0]);
  });

  await claim("a camera's frustum opens by its angle of view, from where it stands", async () => {
    // models/scenes/sensors.yaml: xyz -1.5 -1.8 1.8, rpy 0 0.45 0.75, 640 by 480, 75 degrees; a corner of
    // its frame at 0.25 m.
    const side = Math.tan((75 * Math.PI) / 360);
    // The upper left edge
    const places = [0.25, 0.6].map((depth) => inWorld([depth, depth * side, depth * side * 0.75]));
    const seen = async () => Promise.all(places.map((point) => count("floor", point, kFrustum, 70)));
    assert.deepEqual(await seen(), [0, 0]);
    await overlay(page, "Camera frusta", true);
    await shown(page, seen);
    await overlay(page, "Camera frusta", false);
    assert.deepEqual(await seen(), [0, 0]);
  });

  await claim("its picture stands on its blackboard, as it saw the world", async () => {
    const part = page.getByRole("region", { name: "Part camera" });
    await part.locator("summary", { hasText: "Blackboards" }).click();
    const picture = part.getByRole("img", { name: /^image, taken at \d/ });
    await picture.waitFor();
    const seen = await picture.evaluate((canvas) => {
      const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
      const colors = new Set();
      for (let i = 0; i < data.length; i += 4) colors.add((data[i] >> 5) * 64 + (data[i + 1] >> 5) * 8 + (data[i + 2] >> 5));
      return { width: canvas.width, height: canvas.height, colors: colors.size };
    });
    assert.deepEqual([seen.width, seen.height], [640, 480]);
    assert.ok(seen.colors > 5, `${seen.colors} kinds of colours`);
  });
}, { daemon: [join(source, "models/scenes/sensors.yaml"), "--hold"] });

// Waits until each has some pixels, within a few pictures: readings come from the daemon when the overlay is
// switched on.
async function shown(page, seen) {
  let counts = [];
  for (let picture = 0; picture < 20; ++picture) {
    await drawn(page);
    counts = await seen();
    if (counts.every((count) => count >= 3)) return;
  }
  assert.fail(`not seen: ${counts}`);
}

function inWorld([x, y, z]) {
  const pitch = 0.45, yaw = 0.75;
  const [forward, up] = [x * Math.cos(pitch) + z * Math.sin(pitch), -x * Math.sin(pitch) + z * Math.cos(pitch)];
  return [forward * Math.cos(yaw) - y * Math.sin(yaw) - 1.5, forward * Math.sin(yaw) + y * Math.cos(yaw) - 1.8, up + 1.8];
}
