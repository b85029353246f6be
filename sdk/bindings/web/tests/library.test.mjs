// Libraries in Node.js, from a server that counts requests.

import assert from "node:assert/strict";
import { createServer } from "node:http";
import path from "node:path";
import test from "node:test";
import { pathToFileURL } from "node:url";

import { HTEX_PACKAGE, bytes, difference } from "./fixtures.mjs";

const { Library, open } = await import(pathToFileURL(path.join(HTEX_PACKAGE, "index.node.js")));

/** Serves a file in ranges, and records the requested ranges. `change` changes the replies. */
async function serve(file, change = {}) {
  const requests = [];
  const conditions = [];
  const server = createServer((request, response) => {
    const [, start, end] = /^bytes=(\d+)-(\d+)$/.exec(request.headers.range).map(Number);
    const part = file.subarray(start, end + 1);
    requests.push(part.length);
    const version = change.versions || change.replaced ? `"${requests.length}"` : '"1"';
    const condition = request.headers["if-range"];
    conditions.push(condition);
    // If the file has another version, the server sends the whole file.
    if (change.replaced && condition && condition !== version) return response.writeHead(200).end(file);
    if (change.whole) return response.writeHead(200).end(file);
    if (change.status) return response.writeHead(change.status).end();
    response.writeHead(206, {
      "Content-Range": `bytes ${start}-${start + part.length - 1}/${file.length}`,
      ETag: change.weak ? `W/${version}` : version,
    });
    response.end(change.damage && start > 0 ? Buffer.from(part.map((byte) => byte ^ 1)) : part);
  });
  await new Promise((listening) => server.listen(0, "127.0.0.1", listening));
  const url = `http://127.0.0.1:${server.address().port}/many.htexlib`;
  return { url, requests, conditions, end: () => new Promise((closed) => server.close(closed)) };
}

/** The names in the fixture's library, in order. */
async function names(library) {
  const names = [];
  for await (const entry of library.entries()) names.push(entry.name);
  return names;
}

test("opening a library and a texture takes three requests, and a texture of a known page one", async () => {
  const file = await bytes("many.htexlib");
  const server = await serve(file);
  const library = await Library.open(server.url);
  assert.deepEqual([library.name, library.count], ["Many", 1002]);
  assert.equal(server.requests.length, 1);
  const texture = await library.texture("vinyl");
  const expected = await open(await bytes("vinyl.htex"));
  const [a, b] = [texture, expected].map((t) => t.voice({ model: "ar", seed: 7 }).render(4096));
  assert.equal(difference(a, b), -1);
  assert.equal(server.requests.length, 3);
  assert.ok(server.requests[0] + server.requests[1] <= 64_000, String(server.requests));
  assert.equal(server.requests[2], (await bytes("vinyl.htex")).length);
  assert.deepEqual(await library.bytes("vinyl"), new Uint8Array(await bytes("vinyl.htex")));
  assert.equal(server.requests.length, 4);
  assert.deepEqual(server.conditions, [undefined, '"1"', '"1"', '"1"']);
  await server.end();
});

test("a texture is opened by the address of its library and its name", async () => {
  const server = await serve(await bytes("many.htexlib"));
  const texture = await open(`${server.url}#vinyl`);
  assert.deepEqual(texture.bytes, new Uint8Array(await bytes("vinyl.htex")));
  assert.equal(server.requests.length, 3);
  await assert.rejects(open(`${server.url}#velvet`), { name: "HtexError", message: /velvet/ });
  await server.end();
});

test("a texture whose module others share is whole", async () => {
  const library = await Library.open(await bytes("many.htexlib"));
  const [first, second] = await Promise.all(["bursts", "bursts again"].map((name) => library.bytes(name)));
  const expected = new Uint8Array(await bytes("bursts.htex"));
  assert.deepEqual(first, expected);
  assert.deepEqual(second, expected);
  library.free();
  await assert.rejects(library.bytes("bursts"), { name: "HtexError", code: "bad-handle" });
});

test("entries are the same as the command's", async () => {
  const server = await serve(await bytes("many.htexlib"));
  const library = await Library.open(server.url);
  const listed = JSON.parse(await bytes("many.json"));
  const entries = [];
  for await (const entry of library.entries()) entries.push(entry);
  assert.deepEqual(entries, listed);
  assert.deepEqual(await library.entry("vinyl"), listed.find(({ name }) => name === "vinyl"));
  assert.equal(await library.entry("velvet"), undefined);
  await assert.rejects(library.texture("velvet"), { name: "HtexError", code: "absent" });
  await server.end();
});

test("calls at a time do not disturb each other", async () => {
  const library = await Library.open(await bytes("many.htexlib"));
  const all = await names(library);
  const some = all.filter((_, i) => i % 97 === 0);
  const textures = await Promise.all(some.map((name) => library.texture(name)));
  const listed = await Promise.all(some.map((name) => library.entry(name)));
  assert.deepEqual(listed.map((entry) => entry.name), some);
  assert.equal(textures.length, some.length);
});

test("a server without ranges sends the file once", async () => {
  const server = await serve(await bytes("many.htexlib"), { whole: true });
  const library = await Library.open(server.url);
  await library.texture("vinyl");
  assert.equal(server.requests.length, 1);
  await server.end();
});

test("what is not a library, is damaged or changes is an error that says so", async () => {
  await assert.rejects(Library.open(new Uint8Array(100)), { name: "HtexError", code: "invalid-library" });
  await assert.rejects(Library.open(new Uint8Array(0)), { name: "HtexError", code: "invalid-library" });
  const file = await bytes("many.htexlib");
  await assert.rejects(Library.open(file.subarray(0, 5000)), { code: "invalid-library", message: /LIBRARY_TRUNCATED/ });
  for (const [change, expected] of [
    [{ status: 404 }, { code: "io", message: /404/ }],
    [{ versions: true }, { code: "io", message: /has changed/ }],
    [{ versions: true, weak: true }, { code: "io", message: /has changed/ }],
    [{ replaced: true }, { code: "io", message: /has changed/ }],
    [{ damage: true }, { code: "invalid-library", message: /LIBRARY_PAGE_CHECKSUM/ }],
  ]) {
    const server = await serve(file, change);
    const opened = Library.open(server.url).then((library) => library.texture("vinyl"));
    await assert.rejects(opened, { name: "HtexError", ...expected });
    await server.end();
  }
});

/** Serves the fixtures in ranges or whole, and answers 404 to other names. */
async function serveAll(files) {
  const server = createServer((request, response) => {
    const file = files[request.url.slice(1)];
    if (!file) return response.writeHead(404).end();
    const range = /^bytes=(\d+)-(\d+)$/.exec(request.headers.range ?? "");
    if (!range) return response.writeHead(200).end(file);
    const part = file.subarray(Number(range[1]), Number(range[2]) + 1);
    response.writeHead(206, { "Content-Range": `bytes ${range[1]}-${Number(range[1]) + part.length - 1}/${file.length}`, ETag: '"1"' });
    response.end(part);
  });
  await new Promise((listening) => server.listen(0, "127.0.0.1", listening));
  const end = () => new Promise((closed) => server.close(closed));
  return { url: `http://127.0.0.1:${server.address().port}`, end };
}

test("only what a key signed is opened", async () => {
  const names = ["vinyl.htex", "vinyl.htex.sig", "many.htexlib", "many.htexlib.sig"];
  const files = Object.fromEntries(await Promise.all(names.map(async (name) => [name, await bytes(name)])));
  const [texture, signature, many, signatureOfMany] = names.map((name) => files[name]);
  const key = JSON.parse(signature).public_key;
  const other = "00474ae0c6af07224d0a4250b8a3c82cc7c6e1a9e0e27bce347f01a6bd229caa";
  const server = await serveAll(files);
  const motion = { constant: { speed_mm_s: 80, force_n: 0.4 } };
  const one = Buffer.from(JSON.stringify({ htex_scene: "1.0", surfaces: [{ asset: "vinyl.htex" }], motion, duration_s: 0.1 }));
  const { scene } = await import(pathToFileURL(path.join(HTEX_PACKAGE, "scene.node.js")));
  const inLibrary = async (source, options) => (await Library.open(source, options)).texture("vinyl");
  const ways = [
    (keys) => open(texture, { onlySignedBy: keys, signature }),
    (keys) => open(`${server.url}/vinyl.htex`, { onlySignedBy: keys }),
    (keys) => open(`${server.url}/many.htexlib#vinyl`, { onlySignedBy: keys }),
    (keys) => inLibrary(`${server.url}/many.htexlib`, { onlySignedBy: keys }),
    (keys) => inLibrary(many, { onlySignedBy: keys, signature: signatureOfMany }),
    (keys) => scene(one, { "vinyl.htex": texture, "vinyl.htex.sig": signature }, { onlySignedBy: keys }),
  ];
  for (const [i, way] of ways.entries()) {
    for (const keys of [key, [other, key]]) await way(keys);
    await assert.rejects(way(other), { code: "not-signed", message: /another key/ }, String(i));
    await assert.rejects(way([]), { code: "invalid-argument", message: /onlySignedBy/ }, String(i));
    await assert.rejects(way("alice"), { code: "invalid-argument", message: /64 hexadecimal digits/ }, String(i));
  }
  await assert.rejects(open(texture, { onlySignedBy: key }), { code: "not-signed", message: /no signature/ });
  await assert.rejects(open(texture, { signature }), { code: "invalid-argument", message: /onlySignedBy/ });
  const changed = Buffer.from(many);
  // The hash of the index that the header states is the signed one, and a page is another.
  changed[200] ^= 1;
  await assert.rejects(inLibrary(changed, { onlySignedBy: key, signature: signatureOfMany }));
  delete files["vinyl.htex.sig"];
  await assert.rejects(open(`${server.url}/vinyl.htex`, { onlySignedBy: key }), { code: "not-signed", message: /no signature/ });
  await server.end();
});
