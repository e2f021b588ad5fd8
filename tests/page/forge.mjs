// Changes one input in a recording, with correct CRCs, so that its replay must differ.
import { readFileSync, writeFileSync } from "node:fs";

const kMagicBytes = 8, kHeadBytes = 9;
const kChannel = 0x04, kMessage = 0x05, kChunk = 0x06, kDataEnd = 0x0f;

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

// Replaces the number `from` by `to` in the first input that writes it. Throws if no input does.
export function forge(file, forged, from, to) {
  const bytes = readFileSync(file);
  const wanted = Buffer.alloc(8);
  wanted.writeDoubleLE(from);
  let inputs = -1;
  let done = false;
  for (const { op, content } of recordsOf(bytes, kMagicBytes)) {
    if (op === kDataEnd) content.writeUInt32LE(0, 0); // no CRC of the whole, as the format allows
    if (op !== kChunk || done) continue;
    const records = content.subarray(8 + 8 + 8 + 4 + 4 + 8);
    for (const record of recordsOf(records)) {
      const isInputs = () => record.content.toString("latin1", 8, 8 + record.content.readUInt32LE(4)) === "/inputs";
      if (record.op === kChannel && isInputs()) inputs = record.content.readUInt16LE(0);
      if (record.op !== kMessage || record.content.readUInt16LE(0) !== inputs) continue;
      const at = record.content.indexOf(wanted);
      if (at < 0) continue;
      record.content.writeDoubleLE(to, at);
      done = true;
      break;
    }
    if (done) content.writeUInt32LE(crc32(records), 8 + 8 + 8);
  }
  if (!done) throw new Error(`no input writes ${from}`);
  writeFileSync(forged, bytes);
}
