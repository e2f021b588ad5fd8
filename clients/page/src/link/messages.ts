// The protocol's messages as the page uses them: names for the cases of requests and replies, and their
// errors.
import { create, fromBinary, toBinary, type MessageInitShape } from "@bufbuild/protobuf";
import {
  ClientMessageSchema,
  ErrorCode,
  ServerMessageSchema,
  type ClientMessage,
  type Error as WireError,
  type ServerMessage,
} from "../.generated/visum_pb";
import { frame } from "./frames";
import { readSample } from "./samples";

export * from "../.generated/visum_pb";

export type RequestInit = NonNullable<MessageInitShape<typeof ClientMessageSchema>["request"]>;
export type Body = ServerMessage["body"];
export type BodyCase = Exclude<Body["case"], undefined>;
export type BodyOf<C extends BodyCase> = Extract<Body, { case: C }>["value"];

export class RequestError extends Error {
  readonly code: ErrorCode;
  readonly owner: string;
  constructor(error: Pick<WireError, "code" | "text" | "owner">) {
    super(error.text);
    this.name = "RequestError";
    this.code = error.code;
    this.owner = error.owner;
  }
}

// The connection ended before the answer came.
export class LostError extends Error {}

export function encode(id: number, request: RequestInit): Uint8Array<ArrayBuffer> {
  const message: ClientMessage = create(ClientMessageSchema, { id: BigInt(id), request });
  return frame(toBinary(ClientMessageSchema, message));
}

export function decode(payload: Uint8Array): ServerMessage {
  return readSample(payload) ?? fromBinary(ServerMessageSchema, payload);
}
