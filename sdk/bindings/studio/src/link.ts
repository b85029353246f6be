// A texture in an address: its bytes in the part after `#t=`, which no server sees.

const HEAD = "#t=";

export function toLink(bytes: Uint8Array, page: string): string {
  let text = "";
  for (const byte of bytes) text += String.fromCharCode(byte);
  const base64 = btoa(text).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "");
  return `${page.split("#")[0]}${HEAD}${base64}`;
}

/** The bytes of an address; null if there are none. */
export function fromLink(address: string): Uint8Array | null {
  const at = address.indexOf(HEAD);
  if (at < 0) return null;
  const base64 = address.slice(at + HEAD.length).replaceAll("-", "+").replaceAll("_", "/");
  let text: string;
  try {
    text = atob(base64);
  } catch {
    throw new Error("The link is incomplete: the part after #t= is not a texture. Ask for the link again.");
  }
  return Uint8Array.from(text, (letter) => letter.charCodeAt(0));
}
