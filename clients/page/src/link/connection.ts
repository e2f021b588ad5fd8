// One session with visumd over WebSocket: hello, requests that are answered in order, samples and events. It
// ends for good when the socket closes; link.ts opens the next one.
import { FrameReader } from "./frames";
import {
  decode, encode, ErrorCode, LostError, RequestError, Role,
  type Body, type BodyCase, type BodyOf, type RequestInit, type Welcome,
} from "./messages";
import { Silence } from "./silence";

export const kSubprotocol = "visum.v1";
export const kLookMs = 500;
const kSilentLooks = 6;

export interface HelloOptions {
  name: string;
  role: Role;
  token: string;
}

export interface ConnectionHandler {
  opened(welcome: Welcome): void;
  told(body: Body): void; // a sample or an event
  closed(reason: RequestError | LostError): void;
}

interface Pending {
  waitsForWorld: boolean; // and every request behind it does
  resolve(body: Body): void;
  reject(error: Error): void;
}

export class Connection {
  received = 0; // bytes
  private readonly socket: WebSocket;
  private readonly frames = new FrameReader();
  private readonly pending = new Map<number, Pending>();
  private readonly silence = new Silence(kSilentLooks);
  private nextId = 1;
  private end: RequestError | LostError | null = null;

  constructor(url: string, hello: HelloOptions, private readonly handler: ConnectionHandler) {
    this.socket = new WebSocket(url, kSubprotocol);
    this.socket.binaryType = "arraybuffer";
    this.socket.onopen = () => this.sayHello(hello);
    this.socket.onmessage = (event: MessageEvent<ArrayBuffer>) => this.hear(event.data);
    this.socket.onclose = () => this.finish(new LostError("the connection to visumd is closed"));
  }

  async request<C extends BodyCase>(request: RequestInit, expected: C): Promise<BodyOf<C>> {
    const body = await this.ask(request);
    if (body.case !== expected) throw new Error(`visumd answered the request ${request.case} with ${body.case}`);
    return body.value as BodyOf<C>;
  }

  close(): void {
    this.socket.close();
  }

  // Runs every kLookMs, and gives up on a server that answers no more. While a Step waits for the world,
  // which may stand in a lockstep for any time, the server answers nothing: that is not silence.
  look(): void {
    const answersDue = this.pending.size > 0 && ![...this.pending.values()].some(({ waitsForWorld }) => waitsForWorld);
    if (this.silence.look(answersDue)) this.drop(`visumd has not answered for ${(kSilentLooks * kLookMs) / 1000} s`);
  }

  private drop(reason: string): void {
    this.finish(new LostError(reason));
    this.socket.close();
  }

  private ask(request: RequestInit): Promise<Body> {
    if (this.end) return Promise.reject(this.end);
    if (this.socket.readyState !== WebSocket.OPEN) return Promise.reject(new LostError("not connected"));
    const id = this.nextId++;
    const bytes = encode(id, request); // may throw; then no answer is waited for
    const waitsForWorld = request.case === "step";
    const answer = new Promise<Body>((resolve, reject) => this.pending.set(id, { waitsForWorld, resolve, reject }));
    this.socket.send(bytes);
    return answer;
  }

  private sayHello(hello: HelloOptions): void {
    const token = new TextEncoder().encode(hello.token);
    this.request(
      { case: "hello", value: { minVersion: 1, maxVersion: 1, clientName: hello.name, role: hello.role, token } },
      "welcome",
    ).then(
      (welcome) => this.handler.opened(welcome),
      (error: Error) => this.finish(error instanceof RequestError ? error : new LostError(error.message)),
    );
  }

  private hear(data: ArrayBuffer): void {
    this.received += data.byteLength;
    this.silence.heard();
    try {
      for (const payload of this.frames.read(data)) {
        const message = decode(payload);
        const replyTo = Number(message.replyTo);
        if (replyTo !== 0) this.answer(replyTo, message.body);
        else if (message.body.case === "error") this.finish(new RequestError(message.body.value));
        else this.handler.told(message.body);
      }
    } catch (error) {
      this.drop(`visumd sent a frame that is not a message: ${String(error)}`);
    }
  }

  private answer(id: number, body: Body): void {
    const pending = this.pending.get(id);
    this.pending.delete(id);
    if (body.case === "error") pending?.reject(new RequestError(body.value));
    else pending?.resolve(body);
  }

  private finish(reason: RequestError | LostError): void {
    if (this.end) return;
    this.end = reason;
    for (const pending of this.pending.values()) pending.reject(reason);
    this.pending.clear();
    this.handler.closed(reason);
  }
}

export const needsToken = (error: Error): boolean =>
  error instanceof RequestError && error.code === ErrorCode.ERROR_UNAUTHENTICATED;
