// Keeps leases in order when the page goes. It asks first, gives them back in good order (so that no part
// stops as if its controller were lost), and takes them up again where it was only reloaded.
import { ErrorCode, RequestError } from "../link/messages";
import type { Parts } from "./parts";

const kStored = "visum.leases";
const kReloadMs = 15_000; // later it is no reload: the user has opened the page anew
const kTries = 10;
const kPauseMs = 200; // the session before may end a moment after this one has begun

interface Left {
  parts: string[];
  atMs: number;
}

export function watchLeaving(parts: Parts): void {
  const leased = () => parts.list.value.filter((part) => part.leased.value).map(({ name }) => name);
  window.addEventListener("beforeunload", (event) => leased().length > 0 && event.preventDefault());
  window.addEventListener("pagehide", () => {
    const left: Left = { parts: leased(), atMs: Date.now() };
    if (left.parts.length === 0) return;
    sessionStorage.setItem(kStored, JSON.stringify(left));
    void parts.releaseAll().catch(() => undefined); // nobody is left to hear of an error
  });
}

// Call it once, when the parts are known. Resolves to the names of the parts that this page commands again.
// A part that another client has taken meanwhile stays with that client.
export async function takeUpLeases(parts: Parts): Promise<string[]> {
  const names = leftBefore(sessionStorage.getItem(kStored), Date.now());
  sessionStorage.removeItem(kStored);
  const taken: string[] = [];
  for (const name of names) if (parts.mayCommand && (await takeUp(parts, name))) taken.push(name);
  return taken;
}

async function takeUp(parts: Parts, name: string): Promise<boolean> {
  for (let left = kTries; left > 0; --left) {
    try {
      const part = parts.find(name);
      await part?.acquire();
      return part !== undefined;
    } catch (error) {
      if (!(error instanceof RequestError && error.code === ErrorCode.ERROR_LEASED)) return false;
      await new Promise((done) => setTimeout(done, kPauseMs));
    }
  }
  return false;
}

// Pure.
export function leftBefore(stored: string | null, nowMs: number): string[] {
  try {
    const { parts, atMs } = JSON.parse(stored ?? "{}") as Partial<Left>;
    return Array.isArray(parts) && typeof atMs === "number" && nowMs - atMs < kReloadMs ? parts.filter((name) => typeof name === "string") : [];
  } catch {
    return [];
  }
}
