// Libraries: files with thousands of textures. Only the byte ranges that are needed are fetched.
// The WASM code states which ranges it needs.

import { HtexError } from "./core.js";
import { addressOf, bytesOf, isBlob, library, open, signatureAt } from "./library.js";
import { SIGNED, checked, signedBy } from "./options.js";
import { Handle } from "./texture.js";

/** Number of index pages that are cached. Each has at most 40 KiB. */
const KEPT_PAGES = 16;
/** Number of bytes of the index that are read at once when all entries are listed. */
const READ_AHEAD = 1 << 20;

/** A file on a server, read with HTTP range requests. */
class Remote {
  constructor(url, fetcher) {
    this.url = url;
    this.fetcher = fetcher;
  }

  /** Returns the signature beside the file; undefined if there is none. */
  signature() {
    return signatureAt(this.url, this.fetcher);
  }

  /** Returns the bytes from `start` to `end`, fewer at the end of the file. */
  async read(start, end) {
    if (this.whole) return this.whole.subarray(start, end);
    const headers = { Range: `bytes=${start}-${end - 1}`, ...this.condition() };
    const response = await this.fetcher(this.url, { headers });
    if (response.status === 200) {
      // The server sent ranges before and now sends the whole file. So it may be another version of
      // the file.
      if (this.size !== undefined) throw this.changed();
      // A server without range support sends the whole file.
      this.whole = new Uint8Array(await response.arrayBuffer());
      this.size = this.whole.length;
      return this.whole.subarray(start, end);
    }
    if (response.status === 416) throw new HtexError(`${this.url}: the file is empty or has changed; open it again`, "io");
    if (response.status !== 206) throw new HtexError(`${this.url}: ${response.status} ${response.statusText}`, "io");
    this.check(response, start);
    return new Uint8Array(await response.arrayBuffer());
  }

  /**
   * Returns the header that makes the server send a range only if the file still has the known
   * version. For another origin, this header would need a preflight request each time. So in this
   * case the version is only compared afterwards.
   */
  condition() {
    const page = globalThis.location?.origin;
    const isOwn = page === undefined || page === this.url.origin;
    return isOwn && this.version?.startsWith('"') ? { "If-Range": this.version } : {};
  }

  changed() {
    return new HtexError(`${this.url}: the file has changed; open it again`, "io");
  }

  /**
   * Stores the length and version of the file at the first response. Throws if a later response has
   * others.
   */
  check(response, start) {
    const [, first, size] = /^bytes (\d+)-\d+\/(\d+)$/.exec(response.headers.get("Content-Range") ?? "") ?? [];
    if (size === undefined || Number(first) !== start) {
      throw new HtexError(`${this.url}: the server sends another range than was asked for, or does not show its Content-Range`, "io");
    }
    const version = response.headers.get("ETag");
    if (this.size !== undefined && (this.size !== Number(size) || this.version !== version)) {
      throw this.changed();
    }
    this.size = Number(size);
    this.version = version;
  }
}

/** A file in memory. */
class Local {
  constructor(bytes) {
    this.bytes = bytes;
    this.size = bytes.length;
  }

  async read(start, end) {
    return this.bytes.subarray(start, end);
  }
}

/** A File or a Blob, read in ranges. */
class Chosen {
  constructor(blob) {
    this.blob = blob;
    this.size = blob.size;
  }

  async read(start, end) {
    return new Uint8Array(await this.blob.slice(start, end).arrayBuffer());
  }
}

/** Returns the object that reads a source in ranges. */
async function fileOf(source, fetcher) {
  if (typeof source === "string" || source instanceof URL) return new Remote(addressOf(source, "Library.open"), fetcher);
  return isBlob(source) ? new Chosen(source) : new Local(await bytesOf(source, "Library.open"));
}

/** An open library: a file with thousands of textures. */
export class Library extends Handle {
  /** Opens a library from its address, its bytes, a File or a Blob. */
  static async open(source, options = {}) {
    const { fetch: fetcher = globalThis.fetch.bind(globalThis) } = checked(options, { fetch: "function", ...SIGNED }, "Library.open");
    const signed = signedBy(options, "Library.open");
    const file = await fileOf(source, fetcher);
    const opened = new Library(await library(), file);
    try {
      await opened.start();
      if (signed.onlySignedBy) await opened.checkSigned(signed);
    } catch (error) {
      opened.free();
      throw error;
    }
    return opened;
  }

  constructor(core, file) {
    core.call("htex_index_new", core.results);
    super(core, core.view().getBigUint64(core.results, true), "htex_index_free");
    this.file = file;
    this.pages = new Map();
  }

  /** Reads the header and the root page: one range, or two for a huge library. */
  async start() {
    const { core } = this;
    for (;;) {
      const [start, end] = this.numbers("htex_index_wanted");
      if (start === end) break;
      const bytes = await this.file.read(start, end);
      core.scope((take) => core.call("htex_index_give", this.id, core.put(take, bytes), bytes.length, this.file.size));
    }
    const { pages, ...stated } = JSON.parse(core.text("htex_index_json", this.id));
    Object.assign(this, stated, { pageCount: pages });
  }

  /** Refuses a library that none of the keys signed. Reads the whole index. */
  async checkSigned({ onlySignedBy, signature }) {
    const { core, file } = this;
    const [start, end] = this.numbers("htex_index_range");
    const given = { onlySignedBy, signature: signature ?? (await file.signature?.()) };
    const bytes = await file.read(start, end);
    core.scope((take) => core.call("htex_index_check_signed", this.id, core.put(take, bytes), bytes.length, core.putOpenOptions(take, given)));
  }

  /** Returns the start and end of a range that a function writes. */
  numbers(name, ...values) {
    const { core } = this;
    core.call(name, this.id, ...values, core.results);
    const view = core.view();
    return [view.getFloat64(core.results, true), view.getFloat64(core.results + 8, true)];
  }

  /** Returns the bytes of an index page. Recently used pages are cached. */
  page(number) {
    const [start, end] = this.numbers("htex_index_page_range", number);
    const bytes = this.pages.get(number) ?? this.file.read(start, end);
    this.pages.delete(number);
    this.pages.set(number, bytes);
    bytes.catch(() => this.pages.delete(number));
    if (this.pages.size > KEPT_PAGES) this.pages.delete(this.pages.keys().next().value);
    return bytes;
  }

  /** Yields the numbers and bytes of all index pages. Many pages are read at once. */
  async *allPages() {
    for (let first = 0, end; first < this.pageCount; first = end) {
      const ranges = [];
      for (end = first; end < this.pageCount; end++) {
        const range = this.numbers("htex_index_page_range", end);
        if (ranges.length > 0 && range[1] - ranges[0][0] > READ_AHEAD) break;
        ranges.push(range);
      }
      const start = ranges[0][0];
      const bytes = await this.file.read(start, ranges.at(-1)[1]);
      for (const [i, range] of ranges.entries()) yield [first + i, bytes.subarray(range[0] - start, range[1] - start)];
    }
  }

  /** Selects the page in which entries are looked up, unless it is the selected page. */
  read(number, bytes) {
    if (number === this.selected) return;
    const { core } = this;
    // After an error none is selected.
    this.selected = undefined;
    core.scope((take) => core.call("htex_index_read_page", this.id, number, core.put(take, bytes), bytes.length));
    this.selected = number;
  }

  /**
   * Returns the number of the only index page that can list a texture, or undefined if no page can.
   */
  pageOf(name) {
    const { core } = this;
    return core.scope((take) => {
      core.call("htex_index_page_of", this.id, core.putText(take, name), core.results);
      return core.view().getUint32(core.results, true);
    });
  }

  /** Returns the entries of all textures, in ascending order of their names. */
  async *entries() {
    for await (const [number, bytes] of this.allPages()) {
      this.read(number, bytes);
      yield* JSON.parse(this.core.text("htex_index_entries_json", this.id));
    }
  }

  /**
   * Returns the entries that match a query: `words` in the name or a tag, `tags`, a `speed`, a
   * `force`, a `model`, a `license`, an `author`, a `quantity`, a largest
   * `felt` difference or `held_out` error.
   */
  async *find(query) {
    const text = JSON.stringify(query);
    for await (const [number, bytes] of this.allPages()) {
      this.read(number, bytes);
      yield* this.core.scope((take) => JSON.parse(this.core.text("htex_index_find_json", this.id, this.core.putText(take, text))));
    }
  }

  /** Returns the entry of a texture; undefined if there is no texture with this name. */
  async entry(name) {
    if (this.count === 0) return undefined;
    const number = this.pageOf(name);
    this.read(number, await this.page(number));
    return JSON.parse(this.core.text("htex_index_entries_json", this.id)).find((entry) => entry.name === name);
  }

  /** Returns the bytes of a texture's `.htex` file. */
  async bytes(name) {
    const { core } = this;
    const number = this.pageOf(name);
    const page = await this.page(number);
    this.read(number, page);
    const ranges = this.ranges(name);
    const parts = await Promise.all(ranges.map(([start, end]) => (start === end ? new Uint8Array(0) : this.file.read(start, end))));
    const all = new Uint8Array(parts.reduce((sum, part) => sum + part.length, 0));
    parts.reduce((at, part) => (all.set(part, at), at + part.length), 0);
    // Another call may have selected another page in the meantime.
    this.read(number, page);
    return core.scope((take) => {
      const [given, out] = [core.put(take, all), take(Math.max(all.length, 1))];
      core.call("htex_index_assemble", this.id, core.putText(take, name), given, all.length, out);
      return new Uint8Array(core.exports.memory.buffer, out, all.length).slice();
    });
  }

  /** Returns the byte ranges in the file of a texture that the selected page lists. */
  ranges(name) {
    const { core } = this;
    return core.scope((take) => {
      const text = core.putText(take, name);
      core.call("htex_index_ranges", this.id, text, 0, 0, core.results);
      const count = core.view().getUint32(core.results, true);
      const at = core.putNumbers(take, new Float64Array(2 * count));
      core.call("htex_index_ranges", this.id, text, at, count, core.results);
      const numbers = new Float64Array(core.exports.memory.buffer, at, 2 * count).slice();
      return Array.from({ length: count }, (_, i) => [numbers[2 * i], numbers[2 * i + 1]]);
    });
  }

  /** Opens a texture. */
  async texture(name, options = {}) {
    if (options.onlySignedBy) {
      throw new HtexError("library.texture: a texture is signed with its library; give onlySignedBy to Library.open", "invalid-argument");
    }
    return open(await this.bytes(name), options);
  }
}
