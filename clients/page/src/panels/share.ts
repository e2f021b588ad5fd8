// A panel in a link: compressed, in the part of the address that browsers do not send to servers.

const kPrefix = "#panel=";
const kMostBytes = 1 << 20;

export async function toHash(text: string): Promise<string> {
  const stream = new Blob([text]).stream().pipeThrough(new CompressionStream("deflate-raw"));
  const bytes = new Uint8Array(await new Response(stream).arrayBuffer());
  let binary = "";
  for (const byte of bytes) binary += String.fromCharCode(byte);
  return kPrefix + btoa(binary).replaceAll("+", "-").replaceAll("/", "_").replace(/=+$/, "");
}

// The panel's text; null if the address holds none. Throws if the text is damaged.
export async function fromHash(hash: string): Promise<string | null> {
  if (!hash.startsWith(kPrefix)) return null;
  const binary = atob(hash.slice(kPrefix.length).replaceAll("-", "+").replaceAll("_", "/"));
  const bytes = Uint8Array.from(binary, (letter) => letter.charCodeAt(0));
  const reader = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate-raw")).getReader();
  const decoder = new TextDecoder();
  let text = "";
  for (let part = await reader.read(); !part.done; part = await reader.read()) {
    text += decoder.decode(part.value as Uint8Array, { stream: true });
    if (text.length > kMostBytes) throw new Error("the panel in this link is too large");
  }
  return text + decoder.decode();
}
