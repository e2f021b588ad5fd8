// Changes one input in a recording, with correct CRCs, so that its replay must differ. Chunks are unpacked,
// and the summary is left out, because it tells where the packed ones stood.
import { execFileSync } from "node:child_process";
import { readFileSync, writeFileSync } from "node:fs";

const kMagicBytes = 8, kHeadBytes = 9;
const kFooter = 0x02, kChannel = 0x04, kMessage = 0x05, kChunk = 0x06, kMessageIndex = 0x07, kDataEnd = 0x0f;
const kTimesBytes = 16;

const kTable = Array.from({ length: 256 }, (_, byte) => {
  for (let bit = 0; bit < 8; ++bit) byte = byte & 1 ? (byte >>> 1) ^ 0xedb88320 : byte >>> 1;
  return byte >>> 0;
});
const crc32 = (bytes) => (~bytes.reduce((crc, byte) => kTable[(crc ^ byte) & 0xff] ^ (crc >>> 8), 0xffffffff)) >>> 0;

function* recordsOf(bytes, from = 0) {
  for (let at = from; at + kHeadBytes <= bytes.length; ) {
    const length = Number(bytes.readBigUInt64LE(at + 1));
    const content = bytes.subarray(at + kHeadBytes, at + kHeadBytes + length);
    yield { op: bytes[at], content };
    at += kHeadBytes + length;
  }
}

function record(op, content) {
  const head = Buffer.alloc(kHeadBytes);
  head[0] = op;
  head.writeBigUInt64LE(BigInt(content.length), 1);
  return Buffer.concat([head, content]);
}

// The records in a chunk. Its content: two times, the size unpacked, a CRC, the compression, and the records.
function unpacked(content) {
  const name = content.readUInt32LE(kTimesBytes + 12);
  const from = kTimesBytes + 12 + 4 + name + 8;
  return name === 0 ? content.subarray(from) : execFileSync("zstd", ["-d", "-c"], { input: content.subarray(from), maxBuffer: 1 << 30 });
}

function plainChunk(times, records) {
  const head = Buffer.alloc(8 + 4 + 4 + 8);
  head.writeBigUInt64LE(BigInt(records.length), 0);
  head.writeUInt32LE(crc32(records), 8);
  head.writeBigUInt64LE(BigInt(records.length), 16);
  return record(kChunk, Buffer.concat([times, head, records]));
}

// Replaces the number `from` by `to` in the first input that writes it. Throws if no input does.
export function forge(file, forged, from, to) {
  const bytes = readFileSync(file);
  const wanted = Buffer.alloc(8);
  wanted.writeDoubleLE(from);
  let inputs = -1;
  const replaceIn = (records) => {
    for (const { op, content } of recordsOf(records)) {
      const isInputs = () => content.toString("latin1", 8, 8 + content.readUInt32LE(4)) === "/inputs";
      if (op === kChannel && isInputs()) inputs = content.readUInt16LE(0);
      if (op !== kMessage || content.readUInt16LE(0) !== inputs) continue;
      const at = content.indexOf(wanted);
      if (at < 0) continue;
      content.writeDoubleLE(to, at);
      return true;
    }
    return false;
  };
  let done = false;
  const magic = bytes.subarray(0, kMagicBytes);
  const written = [magic];
  for (const { op, content } of recordsOf(bytes, kMagicBytes)) {
    if (op === kDataEnd) break;
    if (op === kMessageIndex) continue;
    if (op !== kChunk) {
      written.push(record(op, content));
      continue;
    }
    const records = unpacked(content);
    done ||= replaceIn(records);
    written.push(plainChunk(content.subarray(0, kTimesBytes), records));
  }
  if (!done) throw new Error(`no input writes ${from}`);
  // Zeros: no CRC of the data, no summary and no CRC of it, as the format allows.
  written.push(record(kDataEnd, Buffer.alloc(4)), record(kFooter, Buffer.alloc(8 + 8 + 4)), magic);
  writeFileSync(forged, Buffer.concat(written));
}
