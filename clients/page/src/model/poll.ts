// Asks again and again, but never while the last answer is still to come: behind a request that waits for the world,
// questions would pile up at the server. Returns what ends it. `ask` does not fail.
export function poll(ask: () => Promise<void>, periodMs: number): () => void {
  let asking = false;
  const timer = setInterval(() => {
    if (asking) return;
    asking = true;
    void ask().finally(() => (asking = false));
  }, periodMs);
  return () => clearInterval(timer);
}
