// Files that are given to the person who asks for them.

/** Saves bytes under a name. */
export function save(bytes: Uint8Array, name: string, type: string) {
  const url = URL.createObjectURL(new Blob([bytes as Uint8Array<ArrayBuffer>], { type }));
  const link = Object.assign(document.createElement("a"), { href: url, download: name });
  document.body.append(link);
  link.click();
  link.remove();
  setTimeout(() => URL.revokeObjectURL(url), 10_000);
}

/** A texture's name as the name of a file. */
export function fileName(name: string, extension: string) {
  const plain = name.normalize("NFKD").replaceAll(/[^\w\- ]+/g, "").trim().replaceAll(/\s+/g, "-").toLowerCase();
  return `${plain || "texture"}.${extension}`;
}

/** Samples as a WAV file of 32-bit numbers, one channel, with chunks behind them. */
export function wav(samples: Float32Array, rate: number, chunks: Uint8Array = new Uint8Array()): Uint8Array {
  const data = new Uint8Array(58 + 4 * samples.length + chunks.length);
  const view = new DataView(data.buffer);
  const text = (at: number, letters: string) => [...letters].forEach((letter, i) => view.setUint8(at + i, letter.charCodeAt(0)));
  text(0, "RIFF");
  view.setUint32(4, data.length - 8, true);
  text(8, "WAVEfmt ");
  view.setUint32(16, 18, true);
  view.setUint16(20, 3, true); // IEEE float
  view.setUint16(22, 1, true);
  view.setUint32(24, rate, true);
  view.setUint32(28, 4 * rate, true);
  view.setUint16(32, 4, true);
  view.setUint16(34, 32, true);
  text(38, "fact");
  view.setUint32(42, 4, true);
  view.setUint32(46, samples.length, true);
  text(50, "data");
  view.setUint32(54, 4 * samples.length, true);
  samples.forEach((sample, i) => view.setFloat32(58 + 4 * i, sample, true));
  data.set(chunks, 58 + 4 * samples.length);
  return data;
}
