// The framing of the port protocol (protocol/SPEC.md, section 2): a 4-byte little-endian length, then a
// payload.

const kHeaderBytes = 4;
export const kMaxPayload = 64 << 20;

export function frame(payload: Uint8Array): Uint8Array<ArrayBuffer> {
  const bytes = new Uint8Array(kHeaderBytes + payload.length);
  new DataView(bytes.buffer).setUint32(0, payload.length, true);
  bytes.set(payload, kHeaderBytes);
  return bytes;
}

// Cuts a byte stream into payloads, however it is split into messages. Throws if a length is beyond the
// limit.
export class FrameReader {
  private chunks: Uint8Array[] = []; // joined when a frame is whole, because a long frame comes in thousands
  private held = 0; // bytes in them
  private wanted = kHeaderBytes; // with fewer bytes there is nothing new to read

  *read(message: ArrayBuffer): Generator<Uint8Array> {
    this.chunks.push(new Uint8Array(message));
    this.held += message.byteLength;
    if (this.held < this.wanted) return;
    const bytes = join(this.chunks, this.held);
    this.wanted = kHeaderBytes;
    const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    let at = 0;
    while (bytes.length - at >= kHeaderBytes) {
      const length = view.getUint32(at, true);
      if (length > kMaxPayload) throw new Error(`a frame of ${length} bytes`);
      if (bytes.length - at - kHeaderBytes < length) {
        this.wanted = kHeaderBytes + length;
        break;
      }
      yield bytes.subarray(at + kHeaderBytes, at + kHeaderBytes + length);
      at += kHeaderBytes + length;
    }
    this.chunks = [bytes.slice(at)];
    this.held = bytes.length - at;
  }
}

function join(chunks: readonly Uint8Array[], size: number): Uint8Array {
  if (chunks.length === 1) return chunks[0]!;
  const joined = new Uint8Array(size);
  let at = 0;
  for (const chunk of chunks) {
    joined.set(chunk, at);
    at += chunk.length;
  }
  return joined;
}
