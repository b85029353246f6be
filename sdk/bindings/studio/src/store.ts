// What stays on this device: own textures, the history, and settings.

import { signal } from "@preact/signals";

const DATABASE = "htex-studio";
const VERSION = 1;

/** Milliseconds after which a database that has not answered is said not to answer. */
const ANSWER_MS = 1500;
const PARTS = 5;

export interface Own {
  readonly id: string;
  readonly name: string;
  /** Its tags; absent in what earlier versions of the page kept. */
  readonly tags?: readonly string[];
  readonly bytes: Uint8Array;
  readonly added: number;
}

type Store = "own" | "session";

/** Why this browser keeps nothing now; null while it keeps what it is given. */
export const refusal = signal<string | null>(null);

const SILENT = "The browser's storage does not answer.";

function reasonOf(error: unknown) {
  const { name, message } = error instanceof Error ? error : new Error(String(error));
  if (name === "QuotaExceededError") return "The browser has no more room for this page.";
  return `The browser does not let this page store anything (${message || name}).`;
}

let opened: Promise<IDBDatabase> | null = null;
/** The open database, for writing while the page is being closed. */
let connection: IDBDatabase | null = null;

function database() {
  opened ??= new Promise<IDBDatabase>((resolve, reject) => {
    const request = indexedDB.open(DATABASE, VERSION);
    request.onupgradeneeded = () => {
      request.result.createObjectStore("own", { keyPath: "id" });
      request.result.createObjectStore("session");
    };
    request.onsuccess = () => resolve(request.result);
    request.onerror = () => reject(request.error);
  }).then(
    (found) => {
      connection = found;
      // The user cleared the page's data, or a newer page wants to change the database: the next request opens it again.
      found.onclose = forget;
      found.onversionchange = () => (found.close(), forget());
      return found;
    },
    (error) => {
      forget();
      throw error;
    },
  );
  return opened;
}

function forget() {
  opened = null;
  connection = null;
}

/** The answer to a request. */
export function ask<T>(request: IDBRequest<T>): Promise<T> {
  return new Promise((resolve, reject) => {
    request.onsuccess = () => resolve(request.result);
    request.onerror = () => reject(request.error);
  });
}

async function transacted<T>(name: Store, mode: IDBTransactionMode, run: (store: IDBObjectStore) => Promise<T>): Promise<T> {
  const transaction = (await database()).transaction(name, mode);
  const complete = new Promise<void>((resolve, reject) => {
    transaction.oncomplete = () => resolve();
    transaction.onabort = () => reject(transaction.error ?? new Error("a transaction was aborted"));
  });
  try {
    // A browser without room may refuse only at the end.
    const [result] = await Promise.all([run(transaction.objectStore(name)), complete]);
    return result;
  } catch (error) {
    abort(transaction);
    throw transaction.error ?? error;
  }
}

function abort(transaction: IDBTransaction) {
  try {
    transaction.abort();
  } catch {
    // It has ended by itself.
  }
}

/** Waits for the usual time of an answer, in parts: if the page itself was busy, an answer that has come is taken before the next part. */
async function patience() {
  for (let i = 0; i < PARTS; i++) await new Promise((resolve) => setTimeout(resolve, ANSWER_MS / PARTS));
}

/** Runs requests in one transaction. What they wrote is stored once the promise is fulfilled. `run` may wait only for the store's requests. */
export async function transact<T>(name: Store, mode: IDBTransactionMode, run: (store: IDBObjectStore) => Promise<T>): Promise<T> {
  let isAnswered = false;
  void patience().then(() => isAnswered || (refusal.value ??= SILENT));
  try {
    const result = await transacted(name, mode, run);
    if (mode === "readwrite" || refusal.peek() === SILENT) refusal.value = null;
    return result;
  } catch (error) {
    refusal.value = reasonOf(error);
    throw error;
  } finally {
    isAnswered = true;
  }
}

/** Puts a value into the session while the page is being closed: nothing waits for the answer. */
export function putAtOnce(value: unknown, key: string) {
  const transaction = connection?.transaction("session", "readwrite");
  transaction?.objectStore("session").put(value, key);
  transaction?.commit();
}

/** Waits for the database as long as it is usual. Fails when it is late; the request itself goes on. */
export function inTime<T>(answer: Promise<T>): Promise<T> {
  const isLate = refusal.peek() === SILENT ? Promise.resolve() : patience();
  return Promise.race([answer, isLate.then(() => Promise.reject(new Error(SILENT)))]);
}

export const ownIds = () => transact("own", "readonly", (store) => ask(store.getAllKeys() as IDBRequest<string[]>));
export const ownTextures = (ids: readonly string[]) => transact("own", "readonly", (store) => Promise.all(ids.map((id) => ask<Own | undefined>(store.get(id)))));
export const keepOwn = (own: readonly Own[]) => transact("own", "readwrite", (store) => Promise.all(own.map((one) => ask(store.put(one)))));
export const forgetOwn = (id: string) => transact("own", "readwrite", (store) => ask(store.delete(id)));

/** A setting of the page, which the user has entered. */
export const setting = (name: string) => transact("session", "readonly", (store) => ask<string | undefined>(store.get(`setting ${name}`)));
export const keepSetting = (name: string, text: string) => transact("session", "readwrite", (store) => ask(store.put(text, `setting ${name}`)));
