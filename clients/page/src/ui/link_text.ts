// A text in a link: compressed, in the part of the address that browsers do not send to servers.

const kMostBytes = 1 << 20;

// `prefix` names what the text is: "#panel=".
export async function toHash(prefix: string, text: string): Promise<string> {
  const stream = new Blob([text]).stream().pipeThrough(new CompressionStream("deflate-raw"));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  let binary = "";
  for (const byte of bytes) binary += String.fromCharCode(byte);
  return prefix + btoa(binary).replaceAll("+", "-").replaceAll("/", "_").replace(/=+$/, "");
}

// The text; null if the address holds none of this prefix. Throws if the text is damaged.
export async function fromHash(prefix: string, hash: string): Promise<string | null> {
  if (!hash.startsWith(prefix)) return null;
  const binary = atob(hash.slice(prefix.length).replaceAll("-", "+").replaceAll("_", "/"));
  const bytes = Uint8Array.from(binary, (letter) => letter.charCodeAt(0));
  const reader = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw")).getReader();
  const decoder = new TextDecoder();
  let text = "";
  for (let part = await reader.read(); !part.done; part = await reader.read()) {
    text += decoder.decode(part.value as Uint8Array, { stream: true });
    if (text.length > kMostBytes) throw new Error("what this link holds is too large");
  }
  return text + decoder.decode();
}

// Puts the text into the page's address and, where the browser lets us, on the clipboard; true: it is there.
export async function share(prefix: string, text: string): Promise<boolean> {
  history.replaceState(null, "", await toHash(prefix, text));
  // Browsers have no clipboard for pages that come without TLS from another machine.
  return (await navigator.clipboard?.writeText(location.href).then(() => true, () => false)) ?? false;
}
