// Reads a recording with MCAP's own library and with Protobuf's. The first checks the CRC of every chunk, of
// the data, of the summary and of each attachment. The second knows the messages from the descriptions in the
// file alone.
//
//   read.mjs FILE.mcap     prints what is in it as one line of JSON; fails where anything is wrong
import assert from "node:assert/strict";
import { open } from "node:fs/promises";
import { createFileRegistry, fromBinary } from "@bufbuild/protobuf";
import { FileDescriptorSetSchema } from "@bufbuild/protobuf/wkt";
import { McapIndexedReader, McapStreamReader } from "@mcap/core";
import { decompress } from "fzstd";

const path = process.argv[2];
const file = await open(path);

const decompressHandlers = { zstd: (packed, size) => decompress(packed, new Uint8Array(Number(size))) };

// Front to back, as a tool that follows a file would.
const seen = { chunks: 0, messages: {}, attachments: {}, kinds: new Set(), compressions: new Set() };
const channels = new Map();
const schemas = new Map();
const registries = new Map();
let header, lastTick, firstSample;

function decode(channel, data) {
  const schema = schemas.get(channel.schemaId);
  assert.equal(schema.encoding, "protobuf");
  if (!registries.has(schema.id))
    registries.set(schema.id, createFileRegistry(fromBinary(FileDescriptorSetSchema, schema.data)));
  const type = registries.get(schema.id).getMessage(schema.name);
  assert.ok(type, `the schema of ${channel.topic} does not describe ${schema.name}`);
  return fromBinary(type, data);
}

const stream = new McapStreamReader({ validateCrcs: true, includeChunks: true, decompressHandlers });
for await (const bytes of file.createReadStream({ autoClose: false, start: 0 })) {
  stream.append(bytes);
  for (let record; (record = stream.nextRecord()) != undefined; ) {
    seen.kinds.add(record.type);
    if (record.type === "Chunk") {
      seen.chunks++;
      seen.compressions.add(record.compression);
      assert.notEqual(record.uncompressedCrc, 0, "a chunk without a CRC");
    }
    if (record.type === "Schema") schemas.set(record.id, record);
    if (record.type === "Channel") channels.set(record.id, record);
    if (record.type === "Attachment") seen.attachments[record.name] = record.data.byteLength;
    if (record.type === "DataEnd") assert.notEqual(record.dataSectionCrc, 0);
    if (record.type === "Footer") assert.notEqual(record.summaryCrc, 0);
    if (record.type !== "Message") continue;
    const channel = channels.get(record.channelId);
    const message = decode(channel, record.data);
    seen.messages[channel.topic] = (seen.messages[channel.topic] ?? 0) + 1;
    if (channel.topic === "/recording") header = message;
    if (channel.topic === "/ticks") lastTick = message;
    if (message.$typeName === "visum.v1.PartSample") firstSample ??= message;
  }
}
assert.ok(stream.done(), "the file has no end");

// By its index, as a viewer does.
const indexed = await McapIndexedReader.Initialize({
  decompressHandlers,
  readable: {
    size: async () => BigInt((await file.stat()).size),
    read: async (offset, length) => {
      const bytes = new Uint8Array(Number(length));
      await file.read(bytes, 0, bytes.length, Number(offset));
      return bytes;
    },
  },
});
const byTopic = {};
let time = 0n;
for await (const message of indexed.readMessages({ validateCrcs: true })) {
  const { topic } = indexed.channelsById.get(message.channelId);
  byTopic[topic] = (byTopic[topic] ?? 0) + 1;
  assert.ok(message.logTime >= time, "time went back");
  time = message.logTime;
}
assert.deepEqual(byTopic, seen.messages, "the index finds other messages than the file has");
assert.equal(Number(indexed.statistics.messageCount), Object.values(byTopic).reduce((a, b) => a + b, 0));
assert.equal(indexed.chunkIndexes.length, seen.chunks);
assert.equal(indexed.attachmentIndexes.length, Object.keys(seen.attachments).length);
await file.close();

console.log(JSON.stringify({
  chunks: seen.chunks,
  compressions: [...seen.compressions],
  messages: seen.messages,
  attachments: seen.attachments,
  scene: header.scene,
  engines: header.build.engines,
  compiler: header.build.compiler,
  ticks: Number(lastTick.tick),
  state_hash: lastTick.stateHash.toString(16).padStart(16, "0"),
  ports: firstSample.sensorOutputs.length,
}));
