// A server behind a Link, for the tests of the model: what was asked of it, and what it answers.
import type { Link } from "../src/link/link";
import { RequestError, type Body, type ErrorCode, type RequestInit } from "../src/link/messages";
import { Emitter, Signal } from "../src/common/signal";

// `answer` of a request's body; what it throws is the refusal.
export function server(answer: (request: RequestInit) => unknown = () => ({})) {
  const asked: RequestInit[] = [];
  const told = new Emitter<Body>();
  const link = {
    name: "page",
    welcome: { tickNs: 1_000_000n },
    state: new Signal({ kind: "open" }),
    told,
    request: async (request: RequestInit) => {
      asked.push(request);
      return answer(request);
    },
  };
  const tell = (body: Body) => told.emit(body);
  return { asked, tell, link: link as unknown as Link, cases: () => asked.map((request) => request.case) };
}

export const refusal = (code: ErrorCode, text: string) => new RequestError({ code, text, owner: "" });

// Done when all that is not waiting for something has run.
export const settled = () => new Promise<void>((resolve) => setImmediate(resolve));
