import assert from "node:assert/strict";
import { test } from "node:test";
import { create, toBinary, type MessageInitShape } from "@bufbuild/protobuf";
import { Connection } from "../src/link/connection";
import { frame } from "../src/link/frames";
import { Role, ServerMessageSchema } from "../src/link/messages";

type Reply = NonNullable<MessageInitShape<typeof ServerMessageSchema>["body"]>;

class Socket {
  static readonly OPEN = 1;
  readyState = Socket.OPEN;
  onopen: () => void = () => undefined;
  onmessage: (event: { data: ArrayBuffer }) => void = () => undefined;
  close = () => undefined;
  send = () => undefined;
  answer(id: number, body: Reply): void {
    const message = create(ServerMessageSchema, { replyTo: BigInt(id), body });
    this.onmessage({ data: frame(toBinary(ServerMessageSchema, message)).buffer });
  }
}

// A session after its hello, which was the request 1; `looks`: whether it still stands after so many.
function session() {
  let socket = new Socket();
  let isOpen = true;
  globalThis.WebSocket = class extends Socket {
    constructor() {
      super();
      socket = this;
    }
  } as unknown as typeof WebSocket;
  const handler = { opened: () => undefined, told: () => undefined, closed: () => (isOpen = false) };
  const connection = new Connection("", { name: "page", role: Role.ADMIN, token: "" }, handler);
  socket.onopen();
  socket.answer(1, { case: "welcome", value: {} });
  const request = (body: Parameters<Connection["request"]>[0]) => connection.request(body, "ok");
  const ask = (body: Parameters<Connection["request"]>[0]) => request(body).catch(() => undefined);
  const looks = (count: number) => {
    for (let i = 0; i < count; ++i) connection.look();
    return isOpen;
  };
  return { socket, request, ask, looks };
}

test("a server that leaves a question open is given up", () => {
  const { ask, looks } = session();
  void ask({ case: "status", value: {} });
  assert.ok(looks(6));
  assert.ok(!looks(1));
});

test("while a Step waits for the world, what is open is no silence; after it, it is", () => {
  const { socket, ask, looks } = session();
  void ask({ case: "step", value: { ticks: 1n } });
  void ask({ case: "status", value: {} });
  assert.ok(looks(100));
  socket.answer(2, { case: "advanced", value: { tick: 1n } });
  assert.ok(looks(6));
  assert.ok(!looks(1));
});

test("what cannot be written as a message is refused, and no answer to it is waited for", async () => {
  const { request, looks } = session();
  const value = { case: "integer", value: 2n ** 70n } as const;
  await assert.rejects(request({ case: "setParameter", value: { part: "arm", name: "Count", value: { value } } }), /int64/);
  assert.ok(looks(100));
});
