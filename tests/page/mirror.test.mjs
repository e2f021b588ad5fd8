// A mirrored pair on the page of its mirror: the world of the primary, with the shadow arm as a ghost.
import assert from "node:assert/strict";
import { body, drawn, look, overlay, pageTest, until } from "./harness.mjs";
import { linkPositions, readArm } from "./kinematics.mjs";
import { around } from "./picture.mjs";
import { MirroredPair } from "./programs.mjs";

const kJoints = [1, 2, 3, 4, 5, 6, 7];
const sign = (page) => page.locator(".ghost-sign:visible");
const isGhost = (r, g, b) => g > r + 25 && g > b + 5;

pageTest("a mirrored pair shows the shadow arm as a ghost", async (page, claim, pair) => {
  const ghostAt = (link) => page.evaluate((name) => visum.projectGhost(name), `arm/${link}`);
  const seen = async (link) => (await around(page, await ghostAt(link), 12, isGhost)).count;
  await look(page, "Above");

  await claim("as long as the two agree, it is where the primary is", async () => {
    assert.match(await sign(page).textContent(), /^Ghost: the shadow arm, 0\.\d° apart$/);
    const [shown, ghost] = [await body(page, "arm/link_7"), await ghostAt("link_7")];
    assert.ok(Math.hypot(shown.x - ghost.x, shown.y - ghost.y) < 1, JSON.stringify([shown, ghost]));
    assert.equal(await page.evaluate(() => visum.projectGhost("box")), null, "of the arm alone");
  });

  await claim("held back, it is where its own angles put it", async () => {
    pair.holdBack();
    await page.evaluate(async () => {
      await visum.acquire("arm");
      await visum.write("arm", "Desired Angle 1", 0.8);
    });
    await until(page, () => visum.read("arm", "Actual Angle 1") > 0.79 && Math.abs(visum.read("arm", "Actual Speed 1")) < 1e-3);
    await drawn(page);
    const { primary, shadow, ghost } = await page.evaluate((joints) => {
      const primary = joints.map((i) => visum.read("arm", `Actual Angle ${i}`));
      const shadow = primary.map((angle, i) => angle + visum.read("arm_divergence", `Divergence of Actual Angle ${i + 1}`));
      return { primary, shadow, ghost: visum.projectGhost("arm/link_7") };
    }, kJoints);
    assert.ok(primary[0] - shadow[0] > 0.4, `${primary[0]} and ${shadow[0]}`);
    const handAt = async (angles) => {
      const byName = Object.fromEntries(angles.map((angle, i) => [`joint_${i + 1}`, angle]));
      return body(page, "floor", linkPositions(readArm(), byName).get("link_7"));
    };
    const expected = await handAt(shadow);
    assert.ok(Math.hypot(ghost.x - expected.x, ghost.y - expected.y) < 3, JSON.stringify([ghost, expected]));
    const hand = await body(page, "arm/link_7");
    const inPrimary = await handAt(primary);
    assert.ok(Math.hypot(hand.x - inPrimary.x, hand.y - inPrimary.y) < 2, "the arm itself is the primary's");
    assert.ok(Math.hypot(hand.x - ghost.x, hand.y - ghost.y) > 40, "and they are apart");
  });

  await claim("it is seen there, and taken away like other overlays", async () => {
    assert.ok((await seen("link_7")) > 60, `${await seen("link_7")} pixels`);
    await overlay(page, "The other arm of a mirrored pair", false);
    assert.equal(await seen("link_7"), 0);
    assert.equal(await sign(page).count(), 0);
    await overlay(page, "The other arm of a mirrored pair", true);
    assert.ok((await seen("link_7")) > 60);
  });
}, { serve: () => MirroredPair.start() });
