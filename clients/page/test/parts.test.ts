import assert from "node:assert/strict";
import { mock, test } from "node:test";
import { ErrorCode, type PartDescription } from "../src/link/messages";
import { Part } from "../src/model/part";
import { Parts } from "../src/model/parts";
import { refusal, server } from "./server";

mock.method(globalThis, "setInterval", () => 0); // nothing is asked again and again

async function twoOfThreeLeased(refused = "", code = ErrorCode.ERROR_BUSY) {
  const { asked, link } = server((request) => {
    if (request.case === "releaseLease" && request.value.part === refused) throw refusal(code, "too many requests");
    return {};
  });
  const parts = new Parts(link);
  parts.list.value = ["arm", "cart", "eye"].map((name) => new Part(link, { name, controllerInputs: [], sensorOutputs: [] } as unknown as PartDescription));
  for (const name of ["arm", "cart"]) await parts.find(name)!.acquire();
  const released = () => asked.flatMap((request) => (request.case === "releaseLease" ? [request.value.part] : []));
  return { parts, released };
}

test("every lease is released, and no other", async () => {
  const { parts, released } = await twoOfThreeLeased();
  await parts.releaseAll();
  assert.deepEqual(released(), ["arm", "cart"]);
  assert.ok(parts.list.value.every((part) => !part.leased.value));
});

test("a lease that is gone already keeps no other from being released", async () => {
  const { parts, released } = await twoOfThreeLeased("arm", ErrorCode.ERROR_NO_LEASE);
  await parts.releaseAll();
  assert.deepEqual(released(), ["arm", "cart"]);
  assert.ok(parts.list.value.every((part) => !part.leased.value));
});

test("a release that is refused keeps no other from its own", async () => {
  const { parts, released } = await twoOfThreeLeased("arm");
  await assert.rejects(parts.releaseAll(), /too many requests/);
  assert.deepEqual(released(), ["arm", "cart"]);
  assert.deepEqual(parts.list.value.map((part) => part.leased.value), [true, false, false]);
});

test("a release that is refused is told, and its lease and what it holds stay", async () => {
  const { parts } = await twoOfThreeLeased("cart");
  const cart = parts.find("cart")!;
  cart.held.set(0, 1);
  await assert.rejects(parts.releaseAll(), /too many requests/);
  assert.deepEqual([cart.leased.value, cart.held.get(0)], [true, 1]);
});
