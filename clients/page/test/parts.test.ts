import assert from "node:assert/strict";
import { mock, test } from "node:test";
import { create, type MessageInitShape } from "@bufbuild/protobuf";
import { ErrorCode, PartDescriptionSchema, type PartDescription } from "../src/link/messages";
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
  parts.list.value = ["arm", "cart", "eye"].map((name) => new Part(link, { name, parameters: [], controllerInputs: [], sensorOutputs: [] } as unknown as PartDescription));
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

type Described = MessageInitShape<typeof PartDescriptionSchema>;
const gain = (maximum: number, value: number) => ({ name: "Gain", maximum, value: { value: { case: "number" as const, value } } });
const kArm: Described = {
  name: "arm",
  sensorOutputs: [{ name: "Angle", unit: "rad", minimum: -1, maximum: 1 }],
  parameters: [gain(2, 1)],
  blackboards: [{ name: "Log", contentType: "text/plain", elements: 3n }],
};

// True if the part is the same one after a reconnection that describes it as `after`.
async function staysAs(after: Described): Promise<boolean> {
  let described = kArm;
  const { link } = server((request) => {
    if (request.case === "listParts") return { parts: [{ name: "arm", kind: "arm" }] };
    return request.case === "describePart" ? create(PartDescriptionSchema, described) : {};
  });
  const parts = new Parts(link);
  await parts.begin();
  const before = parts.find("arm");
  described = after;
  await parts.begin();
  return parts.find("arm") === before;
}

test("a part is the same one after a reconnection, whatever it holds now and whoever leases it", async () => {
  assert.ok(await staysAs(kArm));
  const blackboards = [{ ...kArm.blackboards![0]!, elements: 8n }];
  assert.ok(await staysAs({ ...kArm, leaseOwner: "bob", parameters: [gain(2, 1.5)], blackboards }));
});

test("another range, unit, parameter or blackboard makes it another part", async () => {
  const port = kArm.sensorOutputs![0]!;
  assert.ok(!(await staysAs({ ...kArm, sensorOutputs: [{ ...port, maximum: 2 }] })));
  assert.ok(!(await staysAs({ ...kArm, sensorOutputs: [{ ...port, unit: "m" }] })));
  assert.ok(!(await staysAs({ ...kArm, parameters: [gain(3, 1)] })));
  assert.ok(!(await staysAs({ ...kArm, blackboards: [] })));
});
