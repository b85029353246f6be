// The package in Node.js.

import { readFile } from "node:fs/promises";
import { Worker as Thread } from "node:worker_threads";

import { host } from "./host.js";

host.readFile = readFile;

/** The thread keeps the program running only while a request is pending. */
host.startThread = (receive, failed) => {
  const thread = new Thread(new URL("./worker.node.js", import.meta.url));
  thread.on("message", receive);
  thread.on("error", ({ message }) => failed(message));
  thread.unref();
  return thread;
};

host.startAuthorThread = () => {
  const thread = new Thread(new URL("./author-worker.node.js", import.meta.url));
  thread.on("message", (data) => thread.onmessage?.({ data }));
  thread.on("error", ({ message }) => thread.onerror?.({ message }));
  return thread;
};

export * from "./index.js";
