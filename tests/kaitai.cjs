// Compiles the descriptions of spec/kaitai, and reads files by them: `node kaitai.cjs QUESTIONS.json`, made by
// tests/it/kaitai.rs. Prints what the libraries hold, and the numbers of the parameter blocks.
const fs = require("fs");
const path = require("path");
const zlib = require("zlib");
const yaml = require("yaml");
const compiler = require("kaitai-struct-compiler");
const KaitaiStream = require("kaitai-struct/KaitaiStream");

const { folder, libraries, blocks } = JSON.parse(fs.readFileSync(process.argv[2], "utf8"));

// The routine that htexlib.ksy asks of a program.
class RawDeflate {
  constructor(length) {
    this.length = length;
  }
  decode(bytes) {
    const unpacked = zlib.inflateRawSync(bytes, { maxOutputLength: Math.max(this.length, 1) });
    if (unpacked.length !== this.length) throw new Error(`${unpacked.length} bytes instead of ${this.length}`);
    return new Uint8Array(unpacked);
  }
}

/** Compiles a description, and returns its class. */
async function compiled(name) {
  const description = yaml.parse(fs.readFileSync(path.join(folder, `${name}.ksy`), "utf8"));
  const files = await compiler.compile("javascript", description, null, false);
  const known = { "kaitai-struct/KaitaiStream": KaitaiStream, RawDeflate: { RawDeflate } };
  const [code] = Object.values(files);
  const module = { exports: {} };
  const required = (what) => {
    if (what in known) return known[what];
    throw new Error(`the compiled ${name} requires ${what}`);
  };
  new Function("module", "exports", "require", code)(module, module.exports, required);
  const exported = module.exports;
  return typeof exported === "function" ? exported : Object.values(exported).find((one) => typeof one === "function");
}

const hex = (bytes) => Buffer.from(bytes).toString("hex");
const values = (list) => list.map((one) => one.value);

const word = (enumeration, value) => enumeration[value].toLowerCase();

/** The texts of a column, each of which begins as the one before it. */
function whole(column) {
  let before = Buffer.alloc(0);
  return column.map((one) => {
    before = Buffer.concat([before.subarray(0, one.lenCommon.value), Buffer.from(one.rest)]);
    return before.toString("utf8");
  });
}

/** What the index of a library says. */
function library(Htexlib, file) {
  const bytes = fs.readFileSync(file);
  const read = new Htexlib(new KaitaiStream(bytes));
  const root = read.rootPage.contents;
  const entries = [];
  for (const { contents } of read.leaves.pages) {
    const names = whole(contents.names);
    let first = contents.start.value;
    names.forEach((name, i) => {
      const range = contents.conditions[i];
      const words = (list) => values(list.words).map((index) => contents.words[index].value);
      const right = (column) => (column && column[i].value ? contents.rights[column[i].value - 1].value : null);
      // The texture: own bytes, with the objects of the shared part inserted.
      const [own, parts] = [read.header.payload.first + first, []];
      let used = 0;
      for (const object of contents.objects[i].objects) {
        const shared = read.header.shared.first + object.first.value;
        parts.push(bytes.subarray(own + used, own + used + object.gap.value));
        parts.push(bytes.subarray(shared, shared + object.length.value));
        used += object.gap.value;
      }
      parts.push(bytes.subarray(own + used, own + contents.lengths[i].value));
      first += contents.lengths[i].value;
      const law = contents.laws[i];
      entries.push({
        name,
        tags: words(contents.tags[i]),
        models: words(contents.models[i]),
        speed: range.flags & 1 ? [range.leastSpeed, range.greatestSpeed ?? range.leastSpeed] : null,
        force: range.flags & 2 ? [range.leastForce, range.greatestForce ?? range.leastForce] : null,
        contact: word(Htexlib.Contact, law.contact),
        law: [law.frequencySpeed, law.levelSpeed, law.levelForce],
        sources: [law.sourceFrequencySpeed, law.sourceLevelSpeed, law.sourceLevelForce].map((source) => word(Htexlib.Source, source)),
        blake3: hex(contents.hashes[i]),
        licence: right(contents.licences),
        author: right(contents.authors),
        quantity: contents.quantities ? word(Htexlib.Quantity, contents.quantities[i]) : null,
        felt: contents.felt && contents.felt[i].value ? (contents.felt[i].value - 1) / 100 : null,
        heldOut: contents.heldOut && contents.heldOut[i].value ? (contents.heldOut[i].value - 1) / 100 : null,
        texture: hex(Buffer.concat(parts)),
      });
    });
  }
  const pages = read.spectra ? read.spectra.pages : [];
  const spectra = pages.reduce((sum, page) => sum + (page.contents ? page.contents.spectra.length : 0), 0);
  return { name: root.name.value, metadata: root.metadata ? JSON.parse(root.metadata) : {}, entries, spectra };
}

const STORES = ["f64", "f32", "u16", "u8", "packed"];

/** The numbers of a block, in one array for each condition: lists are preceded by their lengths. */
function block(HtexParameters, { bytes, fields, conditions }) {
  const stores = fields.map(({ store }) => {
    const kind = typeof store === "string" ? store : STORES.find((name) => name in store);
    return { code: STORES.indexOf(kind), scale: store[kind] };
  });
  const codes = Uint8Array.from(stores, ({ code }) => code);
  const lists = Uint8Array.from(fields, ({ list }) => (list ? 1 : 0));
  const stream = new KaitaiStream(Buffer.from(bytes, "hex"));
  const read = new HtexParameters(stream, null, null, conditions, codes, lists);
  if (!stream.isEof()) throw new Error(`${stream.size - stream.pos} bytes are left`);
  return read.conditions.map((condition) =>
    condition.fields.flatMap((field, i) => {
      const packed = field.packed ? [field.packed.start.first, ...field.packed.rest.map(({ step }) => step)] : [];
      const { scale } = stores[i];
      const numbers = (field.numbers ?? packed).map((q) => {
        if (!scale) return q;
        const value = (scale.offset ?? 0) + scale.scale * q;
        return scale.log ? Math.exp(value) : value;
      });
      return lists[i] ? [field.count, ...numbers] : numbers;
    }),
  );
}

async function main() {
  const [Htexlib, HtexParameters] = await Promise.all(["htexlib", "htex_parameters"].map(compiled));
  const answers = {
    libraries: libraries.map((file) => library(Htexlib, file)),
    blocks: blocks.map((one) => block(HtexParameters, one)),
  };
  process.stdout.write(JSON.stringify(answers));
}
main().catch((error) => {
  console.error(error.stack ?? String(error));
  process.exitCode = 1;
});
