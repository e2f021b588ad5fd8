// The framing of the port protocol (protocol/SPEC.md, section 2): a 4-byte little-endian length, then a payload.

const kHeaderBytes = 4;
export const kMaxPayload = 64 << 20;

export function frame(payload: Uint8Array): Uint8Array<ArrayBuffer> {
  const bytes = new Uint8Array(kHeaderBytes + payload.length);
  new DataView(bytes.buffer).setUint32(0, payload.length, true);
  bytes.set(payload, kHeaderBytes);
  return bytes;
}

// Cuts a byte stream into payloads, however it is split into messages. Throws where a length is beyond the limit.
export class FrameReader {
  private held = new Uint8Array(0);

  *read(message: ArrayBuffer): Generator<Uint8Array> {
    let bytes: Uint8Array = new Uint8Array(message);
    if (this.held.length > 0) {
      const joined = new Uint8Array(this.held.length + bytes.length);
      joined.set(this.held);
      joined.set(bytes, this.held.length);
      bytes = joined;
    }
    const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
    let at = 0;
    while (bytes.length - at >= kHeaderBytes) {
      const length = view.getUint32(at, true);
      if (length > kMaxPayload) throw new Error(`a frame of ${length} bytes`);
      if (bytes.length - at - kHeaderBytes < length) break;
      yield bytes.subarray(at + kHeaderBytes, at + kHeaderBytes + length);
      at += kHeaderBytes + length;
    }
    this.held = bytes.slice(at);
  }
}
