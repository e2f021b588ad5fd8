import "./dom";
import assert from "node:assert/strict";
import { mock, test } from "node:test";
import type { Part } from "../src/model/part";
import { parametersView } from "../src/tree/parameters";
import { all, happens, toasts } from "./dom";
import { server, settled } from "./server";

mock.method(globalThis, "setTimeout", () => 0); // words do not go away

test("a number that cannot be sent is not, and the field shows again what is in force", async () => {
  const parameters = [
    { name: "Count", value: { value: { case: "integer", value: 7n } } },
    { name: "Gain", value: { value: { case: "number", value: 0.5 } } },
  ];
  const { asked, link } = server(() => ({ parameters }));
  Object.assign(link, { recorded: { value: false } });
  const view = parametersView(link, { name: "arm", description: { parameters } } as unknown as Part)!.element;
  Object.assign(view, { open: true });
  happens(view, "toggle");
  await settled();
  asked.length = 0;
  const [count, gain] = all(view, "input");
  for (const [box, text] of [[count!, ""], [gain!, ""], [count!, "1e30"]] as const) {
    box.value = text;
    happens(box, "change");
  }
  assert.deepEqual([count!.value, gain!.value, asked.length], ["7", "0.5", 0]);
  assert.deepEqual(toasts(), ["'Count': whole numbers beyond 9007199254740991 cannot be sent from here"]);
  count!.value = "8";
  happens(count!, "change");
  assert.deepEqual(asked[0], { case: "setParameter", value: { part: "arm", name: "Count", value: { value: { case: "integer", value: 8n } } } });
});
