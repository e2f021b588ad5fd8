import assert from "node:assert/strict";
import { mock, test } from "node:test";
import { create } from "@bufbuild/protobuf";
import { PartDescriptionSchema } from "../src/link/messages";
import { Parts } from "../src/model/parts";
import { isModel, isOfModel, poseOf } from "../src/world/model_files";
import { server, settled } from "./server";

mock.method(globalThis, "setInterval", () => 0); // nothing is asked again and again

test("a place is three numbers, or four with a turn about z", () => {
  assert.deepEqual(poseOf("1, -2  0.5"), [1, -2, 0.5, 1, 0, 0, 0]);
  const turned = poseOf("0,0,0,90");
  assert.ok(Math.abs(turned[3]! - Math.SQRT1_2) < 1e-15 && Math.abs(turned[6]! - Math.SQRT1_2) < 1e-15);
  for (const wrong of ["", "1, 2", "1, 2, x", "1 2 3 4 5"]) assert.throws(() => poseOf(wrong), /x, y, z in m/);
});

test("of a folder, models and what they name are sent, and nothing hidden is a model", () => {
  const paths = ["arm/arm.urdf", "arm/meshes/link.STL", "arm/.github/ci.yaml", "arm/notes.md", "arm/build.zip"];
  assert.deepEqual(paths.filter(isModel), ["arm/arm.urdf"]);
  assert.deepEqual(paths.filter(isOfModel), ["arm/arm.urdf", "arm/meshes/link.STL"]);
});

test("a part that comes with a model is there, one that goes is not, and the others stay the same objects", async () => {
  let names = ["arm"];
  const { link, tell, cases } = server((request) => {
    if (request.case === "listParts") return { parts: names.map((name) => ({ name, kind: "arm" })) };
    return request.case === "describePart" ? create(PartDescriptionSchema, { name: request.value.part! }) : {};
  });
  const parts = new Parts(link);
  await parts.begin();
  const [arm] = parts.list.value;
  await arm!.acquire();
  const changed = async (now: string[]) => {
    names = now;
    tell({ case: "event", value: { kind: "world_changed", part: "" } } as never);
    while (parts.list.value.length !== now.length) await settled();
  };
  await changed(["arm", "cart"]);
  assert.deepEqual(parts.list.value.map(({ name }) => name), ["arm", "cart"]);
  assert.ok(parts.list.value[0] === arm && arm!.leased.value, "and keep their leases");
  await settled();
  assert.equal(cases().filter((name) => name === "subscribe").length, 2, "each is subscribed to once");
  await changed(["arm"]);
  assert.equal(parts.find("cart"), undefined);
});
