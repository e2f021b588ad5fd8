// Look: the picture of the world agrees with its ports; bodies, viewpoints.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { join } from "node:path";
import { body, button, drawn, isBlue, isRed, look, pageTest, until } from "./harness.mjs";
import { linkPositions, readArm } from "./kinematics.mjs";
import { around, colourAt } from "./picture.mjs";
import { bin, source } from "./programs.mjs";

pageTest("loads, and shows the arm where the ports say that it is", async (page, claim) => {
  await claim("names the world and what it is", async () => {
    assert.equal(await page.title(), "amtec_arm · Visum");
    assert.equal(await page.locator(".reality").textContent(), "Virtual");
    assert.equal((await page.evaluate(() => visum.ports())).length, 60);
  });
  await claim("each link is where the model's kinematics put it", () => assertPose(page));
  await claim("bodies have their colours", async () => {
    assert.ok(isRed(...(await colourAt(page, await body(page, "target")))), "the disc is red");
    assert.ok(isBlue(...(await colourAt(page, await body(page, "box")))), "the box is blue");
  });
  await claim("viewpoints of the scene, and home again", async () => {
    const home = await page.evaluate(() => visum.camera());
    await look(page, "Above");
    assert.deepEqual((await page.evaluate(() => visum.camera())).position.map((value) => Number(value.toFixed(6))), [0.35, -0.01, 2.6]);
    await assertPose(page);
    await page.locator(".view canvas").focus();
    await page.keyboard.press("ArrowLeft");
    await page.keyboard.press("Home");
    const again = await page.evaluate(() => visum.camera());
    assert.deepEqual(again.position.map((value) => value.toFixed(6)), home.position.map((value) => value.toFixed(6)));
  });
});

async function assertPose(page) {
  const seen = await page.evaluate((names) => {
    const angles = Object.fromEntries(names.map((_, i) => [`joint_${i + 1}`, visum.read("arm", `Actual Angle ${i + 1}`)]));
    return { angles, bodies: visum.bodies() };
  }, [1, 2, 3, 4, 5, 6, 7]);
  for (const [link, position] of linkPositions(readArm(), seen.angles)) {
    const name = seen.bodies.find((one) => one === link || one.endsWith(`/${link}`));
    if (!name) continue; // the root, which the world holds
    const [shown, expected] = [await body(page, name), await body(page, "floor", position)];
    assert.ok(Math.hypot(shown.x - expected.x, shown.y - expected.y) < 1, `${name}: ${JSON.stringify([shown, expected])}`);
  }
}

pageTest("a Collada visual is shown in its own colours, and told what of it is not shown", async (page) => {
  await drawn(page);
  const [r, g, b] = await colourAt(page, await body(page, "sign/plate", [0.05, 0.1, 0]));
  assert.ok(g > 1.2 * r && r > b, `${[r, g, b]} is green`);
  assert.match(await page.locator(".not-shown").textContent(), /visual 'badge' .* without the textures/);
}, { daemon: [join(source, "tests/page/data/sign.yaml")] });

pageTest("a body is clicked, and pulled", async (page, claim) => {
  const card = page.getByRole("region", { name: "Selected body" });
  const fact = (name) => card.locator(`dt:text-is("${name}") + dd`).textContent();
  await look(page, "Table");
  await claim("by keys, without a click", async () => {
    const choice = page.getByRole("combobox", { name: "Selected body" });
    await choice.focus();
    for (const _ of ["base_link", "link_1", "link_2", "link_3"]) await page.keyboard.press("ArrowDown");
    await until(page, () => document.querySelector(".body-card h2").textContent === "arm/link_3");
    assert.match(await card.textContent(), /Desired Angle 3/);
    await choice.selectOption("No body");
    assert.ok(await card.isHidden());
  });
  await claim("the card says what it is", async () => {
    const { x, y } = await body(page, "box");
    await page.mouse.click(x, y);
    assert.equal(await card.getByRole("heading").textContent(), "box");
    assert.match(await fact("Mass"), /^0\.2000? kg/);
    const [px, py, pz] = (await fact("Position")).match(/[-−]?\d+\.\d+/g).map((text) => Number(text.replace("−", "-")));
    assert.ok(Math.hypot(px - 0.5, py - 0.2, pz - 0.24) < 0.005, `${px} ${py} ${pz}`);
  });
  await claim("a pulled body comes to the hand, which a line leads to, and is not thrown about", async () => {
    const from = await body(page, "box");
    const isLine = (r, g, b) => r > 180 && g > 50 && g < 140 && b < 60;
    await page.keyboard.down("Control");
    await page.mouse.move(from.x, from.y);
    await page.mouse.down();
    await page.mouse.move(from.x - 40, from.y - 80, { steps: 3 });
    const hand = await around(page, { x: from.x - 40, y: from.y - 80 }, 10, isLine);
    assert.ok(hand.count > 20 && Math.hypot(hand.x - 10, hand.y - 10) < 2, JSON.stringify(hand));
    await until(page, ({ x, y }) => {
      const now = visum.project("box");
      window.fastest = Math.max(window.fastest ?? 0, Number.parseFloat(document.querySelector(".body-card dl").textContent.match(/Speed([\d.]+)/)[1]));
      return Math.hypot(now.x - x, now.y - y) < 40;
    }, { x: from.x - 40, y: from.y - 80 });
    const held = await page.evaluate(() => visum.simTime());
    await until(page, (time) => visum.simTime() > time + 1, held);
    assert.ok((await page.evaluate(() => window.fastest)) < 3);
    await page.mouse.up();
    await page.keyboard.up("Control");
  });
});

pageTest("in a narrow view the card of a body does not hide it", async (page) => {
  const card = page.getByRole("region", { name: "Selected body" });
  for (const name of ["arm/link_3", "table"]) {
    await page.getByRole("combobox", { name: "Selected body" }).selectOption(name);
    const [{ x, y }, box] = [await body(page, name), await card.boundingBox()];
    assert.ok(x < box.x || x > box.x + box.width || y < box.y || y > box.y + box.height, `${name} at ${x}, ${y}, the card at ${JSON.stringify(box)}`);
  }
  const mass = card.locator("dt", { hasText: "Mass" });
  assert.ok(await mass.isHidden());
  await card.getByRole("button", { name: "More" }).click();
  assert.ok(await mass.isVisible());
}, { viewport: { width: 390, height: 844 } });

pageTest("a finger pulls a body by a long press, and orbits without one", async (page) => {
  await look(page, "Table");
  const from = await body(page, "box");
  const touch = await page.context().newCDPSession(page);
  const send = (type, x, y) => touch.send("Input.dispatchTouchEvent", { type, touchPoints: type === "touchEnd" ? [] : [{ x, y }] });
  await send("touchStart", from.x, from.y);
  await until(page, () => document.querySelector(".body-card h2").textContent === "box"); // it is held
  const camera = await page.evaluate(() => visum.camera());
  await send("touchMove", from.x + 60, from.y - 60);
  await until(page, (x) => visum.project("box").x > x + 20, from.x);
  await send("touchEnd");
  assert.deepEqual(await page.evaluate(() => visum.camera()), camera, "the camera stands still meanwhile");
}, { hasTouch: true });

// Bodies behind the removed one get other numbers.
const removeBody = (daemon, name) =>
  execFileSync(process.env.VISUM_PYTHON ?? "/usr/bin/python3", ["-c", "import sys, visum; visum.Client(sys.argv[1], role='admin').remove_body(sys.argv[2])", `127.0.0.1:${daemon.port}`, name],
    { env: { ...process.env, PYTHONPATH: join(bin, "../python") } });

pageTest("a body goes while time stands: the others stay where they are, and the one that is followed is", async (page, claim, daemon) => {
  const follow = page.getByRole("button", { name: "Follow" });
  const select = () => page.getByRole("combobox", { name: "Selected body" }).selectOption({ label: "box" });
  await button(page, "Pause").click();
  // Enabled once the pause is in force
  await page.getByRole("button", { name: "Single tick" }).click({ trial: true });
  await select();
  await follow.click();
  await drawn(page);
  const before = await body(page, "box");
  removeBody(daemon, "table");
  await until(page, () => !visum.bodies().includes("table") && document.querySelector(".body-card").hidden);
  await drawn(page);
  await claim("it is drawn where it was", async () => {
    const after = await body(page, "box");
    assert.ok(Math.hypot(after.x - before.x, after.y - before.y) < 1, JSON.stringify([before, after]));
  });
  await claim("and followed", async () => {
    await select();
    assert.equal(await follow.getAttribute("aria-pressed"), "true");
  });
});
