// A QR code, and files with its image. The module comes when the first code is shown.

import { encode } from "uqr";

/** White modules around a code. Readers find a code by this quiet zone. */
const QUIET = 4;
/** Pixels of a module in a PNG. */
const PNG_PIXELS = 8;

/** Rows of modules, the quiet zone included; true is black. */
export type Code = readonly (readonly boolean[])[];

/** The code of a text of at most `MOST_CHARACTERS`. It corrects as many errors as fit without a larger code. */
export function toCode(text: string): Code {
  return encode(text, { ecc: "L", boostEcc: true, border: QUIET }).data;
}

/** The runs of black modules: where each one begins, and how long it is. */
function* runs(code: Code) {
  for (const [y, row] of code.entries()) {
    for (let x = row.indexOf(true); x >= 0; ) {
      const end = row.indexOf(false, x);
      yield { x, y, length: end - x };
      x = row.indexOf(true, end);
    }
  }
}

/** Black on white, in light and in dark mode. */
export function toSvg(code: Code): string {
  const path = Array.from(runs(code), ({ x, y, length }) => `M${x} ${y}h${length}v1h-${length}z`).join("");
  const size = code.length;
  return `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${size} ${size}" shape-rendering="crispEdges"><path fill="#fff" d="M0 0h${size}v${size}H0z"/><path d="${path}"/></svg>`;
}

export async function toPng(code: Code): Promise<Uint8Array> {
  const size = PNG_PIXELS * code.length;
  const canvas = Object.assign(document.createElement("canvas"), { width: size, height: size });
  const pen = canvas.getContext("2d");
  if (!pen) throw new Error("the browser has no memory for an image; close other pages");
  pen.fillStyle = "#fff";
  pen.fillRect(0, 0, size, size);
  pen.fillStyle = "#000";
  for (const { x, y, length } of runs(code)) pen.fillRect(PNG_PIXELS * x, PNG_PIXELS * y, PNG_PIXELS * length, PNG_PIXELS);
  const blob = await new Promise<Blob | null>((resolve) => canvas.toBlob(resolve, "image/png"));
  if (!blob) throw new Error("the browser has no memory for an image; close other pages");
  return new Uint8Array(await blob.arrayBuffer());
}
