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
