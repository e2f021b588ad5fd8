import assert from "node:assert/strict";
import { test } from "node:test";
import { frame, FrameReader, kMaxPayload } from "../src/link/frames";
import { ClientMessageSchema, decode, encode, RequestError, ServerMessageSchema } from "../src/link/messages";
import { create, fromBinary, toBinary } from "@bufbuild/protobuf";

const bytes = (...values: number[]) => Uint8Array.from(values);
const read = (reader: FrameReader, message: Uint8Array<ArrayBuffer>) => [...reader.read(message.slice().buffer)].map((payload) => [...payload]);

test("a frame is its length, little-endian, and its payload", () => {
  assert.deepEqual([...frame(bytes(7, 8, 9))], [3, 0, 0, 0, 7, 8, 9]);
});

test("frames come out whole, wherever the stream is cut into messages", () => {
  const stream = Uint8Array.from([...frame(bytes(1, 2)), ...frame(bytes()), ...frame(bytes(3, 4, 5))]);
  for (let cut = 0; cut <= stream.length; ++cut) {
    const reader = new FrameReader();
    const payloads = [...read(reader, stream.slice(0, cut)), ...read(reader, stream.slice(cut))];
    assert.deepEqual(payloads, [[1, 2], [], [3, 4, 5]], `cut at ${cut}`);
  }
});

test("a frame that comes in many messages is one, and the next begins behind it", () => {
  const long = Uint8Array.from({ length: 1000 }, (_, i) => i % 251);
  const stream = Uint8Array.from([...frame(long), ...frame(bytes(1, 2))]);
  for (const size of [1, 3, 7, 64]) {
    const reader = new FrameReader();
    const payloads: number[][] = [];
    for (let at = 0; at < stream.length; at += size) payloads.push(...read(reader, stream.slice(at, at + size)));
    assert.deepEqual(payloads, [[...long], [1, 2]], `messages of ${size}`);
  }
});

test("a frame beyond the limit is refused before its payload comes", () => {
  const header = new Uint8Array(4);
  new DataView(header.buffer).setUint32(0, kMaxPayload + 1, true);
  assert.throws(() => read(new FrameReader(), header), /a frame of 67108865 bytes/);
});

// The example of protocol/SPEC.md, section 2: what the server writes and reads.
test("messages are the protocol's, bit by bit", () => {
  const request = encode(6, { case: "releaseLease", value: { part: "arm" } });
  assert.equal(Buffer.from(request).toString("hex"), "09000000" + "0806" + "6a05" + "0a0361726d");
  const advanced = decode(Buffer.from("0805" + "6209" + "080a" + "1080ade204" + "1801", "hex"));
  assert.equal(advanced.replyTo, 5n);
  assert.deepEqual([advanced.body.case, advanced.body.case === "advanced" && advanced.body.value.simTimeNs], ["advanced", 10_000_000n]);
});

test("a message survives the way there and back", () => {
  const values = [0, -1.5, 1e300, Number.MIN_VALUE];
  const request = { case: "write", value: { part: "arm", firstPort: 3, values, sequence: 9n } } as const;
  const [payload] = [...new FrameReader().read(encode(1, request).buffer)];
  const back = fromBinary(ClientMessageSchema, payload!);
  assert.equal(back.request.case, "write");
  assert.deepEqual(back.request.case === "write" && back.request.value.values, values);
});

test("a refusal keeps its code and names the owner", () => {
  const message = create(ServerMessageSchema, { replyTo: 1n, body: { case: "error", value: { code: 7, text: "'arm' is leased by bob", owner: "bob" } } });
  const { body } = decode(toBinary(ServerMessageSchema, message));
  assert.ok(body.case === "error");
  const error = new RequestError(body.value);
  assert.deepEqual([error.code, error.message, error.owner], [7, "'arm' is leased by bob", "bob"]);
});
