// Reads samples of parts and of the world, which come a thousand times a second where ports are plotted. The
// general decoder, which takes any message apart by its description, takes several times as long. Pure.
import type { ContactSample, PartSample, ServerMessage, WorldSample } from "../.generated/visum_pb";

// Numbers of fields in visum.proto, with their wire types: 0 varint, 1 eight bytes, 2 length and bytes.
const kPartSample = 9, kWorldSample = 14; // of ServerMessage
const kLittle = 28; // bits of a varint that are put together as small integers
const kHigh = 2 ** kLittle;
const kSafeHigh = 2 ** (53 - kLittle);

class Unknown extends Error {} // a field or wire type that this reader does not know

class Reader {
  private readonly view: DataView;
  constructor(private readonly bytes: Uint8Array, public at = 0, readonly end = bytes.length) {
    this.view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  }

  get more(): boolean {
    return this.at < this.end;
  }

  // A varint below 2^28: tags, lengths, indices.
  small(): number {
    let value = 0;
    for (let shift = 0; shift < kLittle; shift += 7) {
      const byte = this.byte();
      value |= (byte & 0x7f) << shift;
      if (byte < 0x80) return value;
    }
    throw new Unknown();
  }

  unsigned(): bigint {
    let [low, high, top] = [0, 0, 0]; // 28, 28 and 8 bits
    for (let i = 0; i < 10; ++i) {
      const byte = this.byte();
      if (i < 4) low |= (byte & 0x7f) << (7 * i);
      else if (i < 8) high |= (byte & 0x7f) << (7 * (i - 4));
      else top |= (byte & 0x7f) << (7 * (i - 8));
      if (byte >= 0x80) continue;
      if (top === 0 && high < kSafeHigh) return BigInt(low + high * kHigh);
      return BigInt.asUintN(64, BigInt(low) | (BigInt(high) << 28n) | (BigInt(top) << 56n));
    }
    throw new Unknown();
  }

  signed(): bigint {
    return BigInt.asIntN(64, this.unsigned());
  }

  double(): number {
    this.at += 8;
    if (this.at > this.end) throw new Unknown();
    return this.view.getFloat64(this.at - 8, true);
  }

  // The bytes of a field that has a length.
  inside(): Reader {
    const length = this.small();
    const from = this.at;
    this.at += length;
    if (this.at > this.end) throw new Unknown();
    return new Reader(this.bytes, from, this.at);
  }

  doubles(): number[] {
    const inside = this.inside();
    const values = new Array<number>((inside.end - inside.at) / 8); // throws where it is not whole
    for (let i = 0; i < values.length; ++i) values[i] = inside.double();
    return values;
  }

  text(): string {
    const inside = this.inside();
    const bytes = this.bytes.subarray(inside.at, inside.end);
    return bytes.every((byte) => byte < 0x80) ? String.fromCharCode(...bytes) : new TextDecoder().decode(bytes);
  }

  private byte(): number {
    if (this.at >= this.end) throw new Unknown();
    return this.bytes[this.at++]!;
  }
}

// Null where the payload is another message, or has a field that this reader does not know. Then the general
// decoder takes it.
export function readSample(payload: Uint8Array): ServerMessage | null {
  try {
    const reader = new Reader(payload);
    const tag = reader.small();
    if (tag !== ((kPartSample << 3) | 2) && tag !== ((kWorldSample << 3) | 2)) return null;
    const inside = reader.inside();
    if (reader.more) return null;
    const body = tag >> 3 === kPartSample ? { case: "partSample" as const, value: readPart(inside) } : { case: "worldSample" as const, value: readWorld(inside) };
    return { $typeName: "visum.v1.ServerMessage", replyTo: 0n, body };
  } catch (error) {
    if (error instanceof Unknown || error instanceof RangeError) return null;
    throw error;
  }
}

function readPart(from: Reader): PartSample {
  const sample: PartSample = { $typeName: "visum.v1.PartSample", part: "", tick: 0n, simTimeNs: 0n, era: 0n, controllerInputs: [], sensorOutputs: [], conflated: 0n };
  while (from.more)
    switch (from.small()) {
      case (1 << 3) | 2: sample.part = from.text(); break;
      case 2 << 3: sample.tick = from.signed(); break;
      case 3 << 3: sample.simTimeNs = from.signed(); break;
      case 4 << 3: sample.era = from.unsigned(); break;
      case (5 << 3) | 2: sample.controllerInputs = from.doubles(); break;
      case (6 << 3) | 2: sample.sensorOutputs = from.doubles(); break;
      case 7 << 3: sample.conflated = from.unsigned(); break;
      default: throw new Unknown();
    }
  return sample;
}

function readWorld(from: Reader): WorldSample {
  const sample: WorldSample = {
    $typeName: "visum.v1.WorldSample", tick: 0n, simTimeNs: 0n, era: 0n, poses: [], velocities: [], jointPositions: [], jointVelocities: [], jointEfforts: [],
    followingErrors: [], peakFollowingErrors: [], peakContactForces: [], contacts: [], stateHash: 0n, revision: 0n, conflated: 0n,
  };
  while (from.more)
    switch (from.small()) {
      case 1 << 3: sample.tick = from.signed(); break;
      case 2 << 3: sample.simTimeNs = from.signed(); break;
      case 3 << 3: sample.era = from.unsigned(); break;
      case (4 << 3) | 2: sample.poses = from.doubles(); break;
      case (5 << 3) | 2: sample.velocities = from.doubles(); break;
      case (6 << 3) | 2: sample.jointPositions = from.doubles(); break;
      case (7 << 3) | 2: sample.jointVelocities = from.doubles(); break;
      case (8 << 3) | 2: sample.jointEfforts = from.doubles(); break;
      case (9 << 3) | 2: sample.followingErrors = from.doubles(); break;
      case (10 << 3) | 2: sample.peakFollowingErrors = from.doubles(); break;
      case (11 << 3) | 2: sample.peakContactForces = from.doubles(); break;
      case (12 << 3) | 2: sample.contacts.push(readContact(from.inside())); break;
      case 13 << 3: sample.stateHash = from.unsigned(); break;
      case 14 << 3: sample.revision = from.unsigned(); break;
      case 15 << 3: sample.conflated = from.unsigned(); break;
      default: throw new Unknown();
    }
  return sample;
}

function readContact(from: Reader): ContactSample {
  const contact: ContactSample = { $typeName: "visum.v1.ContactSample", bodyA: 0, bodyB: 0, position: [], normal: [], depth: 0, normalForceN: 0 };
  while (from.more)
    switch (from.small()) {
      case 1 << 3: contact.bodyA = from.small(); break;
      case 2 << 3: contact.bodyB = from.small(); break;
      case (3 << 3) | 2: contact.position = from.doubles(); break;
      case (4 << 3) | 2: contact.normal = from.doubles(); break;
      case (5 << 3) | 1: contact.depth = from.double(); break;
      case (6 << 3) | 1: contact.normalForceN = from.double(); break;
      default: throw new Unknown();
    }
  return contact;
}
