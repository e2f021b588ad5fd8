// Asks again and again, and waits for each answer first. Otherwise questions would pile up at the server
// behind a request that waits for the world. Returns a function that ends the polling. `ask` must not fail.
export function poll(ask: () => Promise<void>, periodMs: number): () => void {
  let asking = false;
  const timer = setInterval(() => {
    if (asking) return;
    asking = true;
    void ask().finally(() => (asking = false));
  }, periodMs);
  return () => clearInterval(timer);
}
