// Overlays: each is at the place that kinematics and physics say, in its colour, and gone when switched off.
import assert from "node:assert/strict";
import { body, button, control, drawn, isRed, look, overlay, pageTest, settled, until } from "./harness.mjs";
import { linkPositions, readArm } from "./kinematics.mjs";
import { around, colourAt, like } from "./picture.mjs";

const kCentre = [0xb0, 0x49, 0x9a], kTrail = kCentre, kAxis = [0x00, 0x72, 0xb2], kContact = [0xd5, 0x5e, 0x00];
const floor = (page, point) => body(page, "floor", point);

const angles = (page) => page.evaluate(() => Object.fromEntries([1, 2, 3, 4, 5, 6, 7].map((i) => [`joint_${i}`, visum.read("arm", `Actual Angle ${i}`)])));

pageTest("overlays are laid over the world, and taken away", async (page, claim) => {
  await button(page, "Pause").click();
  await claim("centres of mass", async () => {
    const place = await body(page, "box");
    const count = async () => (await around(page, place, 15, like(kCentre))).count;
    assert.equal(await count(), 0);
    await overlay(page, "Centres of mass", true);
    const found = await around(page, place, 15, like(kCentre));
    assert.ok(found.count > 20 && Math.hypot(found.x - 15, found.y - 15) < 1, JSON.stringify(found));
    await overlay(page, "Centres of mass", false);
    assert.equal(await count(), 0);
  });
  await claim("frames: x red, y green, z blue", async () => {
    await look(page, "Table");
    await drawn(page);
    const axes = [[[0.1, 0, 0], (r, g, b) => r > 200 && b < 90], [[0, 0.1, 0], (r, g, b) => g > 200 && b < 90], [[0, 0, 0.1], (r, g, b) => b > 180 && r < 60]];
    const counts = async () => Promise.all(axes.map(async ([end, is]) => (await around(page, await body(page, "box", end), 3, is)).count));
    assert.deepEqual(await counts(), [0, 0, 0]);
    await overlay(page, "Frames of bodies", true);
    assert.ok((await counts()).every((count) => count > 0), JSON.stringify(await counts()));
    await overlay(page, "Frames of bodies", false);
    assert.deepEqual(await counts(), [0, 0, 0]);
  });
  await claim("contacts: the box pushes on the table, where it stands on it", async () => {
    const under = await body(page, "box", [0, 0, -0.02]);
    const count = async () => (await around(page, under, 40, like(kContact))).count;
    assert.equal(await count(), 0);
    await overlay(page, "Contacts and forces", true);
    assert.ok((await count()) > 30, `${await count()} pixels of arrows`);
    await overlay(page, "Contacts and forces", false);
    assert.equal(await count(), 0);
  });
  await claim("collision shapes: what only is looked at goes, what collides is a wire frame", async () => {
    const disc = await body(page, "target");
    assert.ok(isRed(...(await colourAt(page, disc))));
    const blue = like(await colourAt(page, await body(page, "box")), 30);
    const boxArea = async () => (await around(page, await body(page, "box"), 20, blue)).count;
    const solid = await boxArea();
    await overlay(page, "Collision shapes", true);
    assert.ok(!isRed(...(await colourAt(page, disc))));
    assert.ok((await boxArea()) < solid / 2, `${await boxArea()} of ${solid} pixels`);
    await overlay(page, "Collision shapes", false);
    assert.ok(isRed(...(await colourAt(page, disc))));
  });
  await claim("joint axes with their angles", async () => {
    await look(page, "Side");
    await drawn(page);
    const place = await floor(page, linkPositions(readArm(), await angles(page)).get("link_4"));
    const count = async () => (await around(page, place, 45, like(kAxis))).count;
    assert.equal(await count(), 0);
    await overlay(page, "Joint axes and angles", true);
    assert.ok((await count()) > 20, `${await count()} pixels of the axis`);
    const degrees = ((await angles(page)).joint_4 * 180) / Math.PI;
    const shown = (await page.locator(".labels span:visible").allTextContents()).map((text) => parseFloat(text.replace("−", "-")));
    // The port tells of the motor, the label of the joint: the gear between them gives a little.
    assert.ok(shown.some((value) => Math.abs(value - degrees) < 0.2), `${shown} without ${degrees}`);
    await overlay(page, "Joint axes and angles", false);
    assert.equal(await page.locator(".labels span:visible").count(), 0);
    assert.equal(await count(), 0);
  });
});

pageTest("trails: the way that a link went", async (page) => {
  await look(page, "Above");
  await overlay(page, "Trails", true);
  await control(page);
  await page.evaluate(() => visum.write("arm", "Desired Angle 1", 0.5));
  await until(page, () => visum.read("arm", "Actual Angle 1") > 0.49);
  await button(page, "Pause").click();
  await drawn(page);
  const now = await angles(page);
  const wayOfHand = [0.15, 0.25, 0.35].map((joint_1) => linkPositions(readArm(), { ...now, joint_1 }).get("link_7"));
  const counts = async () => Promise.all(wayOfHand.map(async (point) => (await around(page, await floor(page, point), 4, like(kTrail, 60))).count));
  const seen = await counts();
  await overlay(page, "Trails", false);
  const gone = await counts();
  assert.ok(seen.every((count, i) => count >= gone[i] + 3), JSON.stringify([seen, gone]));
});

pageTest("a followed link stays where it is on the screen while it moves", async (page) => {
  const card = page.getByRole("region", { name: "Selected body" });
  await look(page, "Front");
  const { x, y } = await body(page, "arm/link_2", [0, -0.25, 0]);
  await page.mouse.click(x, y);
  const name = await card.getByRole("heading").textContent();
  assert.match(name, /^arm\//);
  assert.match(await card.textContent(), /Desired Angle/);
  await control(page);
  const moves = async (angle) => {
    await settled(page, name);
    const [before, table] = [await body(page, name), await body(page, "table")];
    await page.evaluate((value) => visum.write("arm", "Desired Angle 2", value), angle);
    await until(page, (value) => Math.abs(visum.read("arm", "Actual Angle 2") - value) < 0.005 && Math.abs(visum.read("arm", "Actual Speed 2")) < 2e-3, angle);
    await drawn(page);
    await settled(page, name);
    const [after, tableAfter] = [await body(page, name), await body(page, "table")];
    return { link: Math.hypot(after.x - before.x, after.y - before.y), table: Math.hypot(tableAfter.x - table.x, tableAfter.y - table.y) };
  };
  await card.getByRole("button", { name: "Follow" }).click();
  const followed = await moves(0.1);
  assert.ok(followed.link < 1 && followed.table > 15, JSON.stringify(followed));
  await card.getByRole("button", { name: "Follow" }).click();
  const free = await moves(-0.3);
  assert.ok(free.link > 15 && free.table < 1, JSON.stringify(free));
});
