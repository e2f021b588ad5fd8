// A server behind a Link, for the tests of the model: what was asked of it, and what it answers.
import type { Link } from "../src/link/link";
import { RequestError, type ErrorCode, type RequestInit } from "../src/link/messages";

// `answer` of a request's body; what it throws is the refusal.
export function server(answer: (request: RequestInit) => unknown = () => ({})) {
  const asked: RequestInit[] = [];
  const link = {
    name: "page",
    welcome: { tickNs: 1_000_000n },
    told: { on: () => () => undefined },
    request: async (request: RequestInit) => {
      asked.push(request);
      return answer(request);
    },
  };
  return { asked, link: link as unknown as Link, cases: () => asked.map((request) => request.case) };
}

export const refusal = (code: ErrorCode, text: string) => new RequestError({ code, text, owner: "" });

// Done when all that is not waiting for something has run.
export const settled = () => new Promise<void>((resolve) => setImmediate(resolve));
