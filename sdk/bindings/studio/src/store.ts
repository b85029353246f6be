// What stays on this device: own textures, and the work of last time.

const DATABASE = "htex-studio";
const VERSION = 1;

export interface Own {
  readonly id: string;
  readonly name: string;
  /** Its tags; absent in what earlier versions of the page kept. */
  readonly tags?: readonly string[];
  readonly bytes: Uint8Array;
  readonly added: number;
}

let opened: Promise<IDBDatabase> | null = null;

function database() {
  opened ??= new Promise((resolve, reject) => {
    const request = indexedDB.open(DATABASE, VERSION);
    request.onupgradeneeded = () => {
      request.result.createObjectStore("own", { keyPath: "id" });
      request.result.createObjectStore("session");
    };
    request.onsuccess = () => resolve(request.result);
    request.onerror = () => reject(request.error);
  });
  return opened;
}

async function ask<T>(store: string, mode: IDBTransactionMode, what: (store: IDBObjectStore) => IDBRequest<T>): Promise<T> {
  const transaction = (await database()).transaction(store, mode);
  const request = what(transaction.objectStore(store));
  return new Promise((resolve, reject) => {
    request.onsuccess = () => resolve(request.result);
    request.onerror = () => reject(request.error);
  });
}

/** Runs requests of one transaction, and waits for its end. */
async function askAll<T>(mode: IDBTransactionMode, requests: (store: IDBObjectStore) => IDBRequest<T>[]): Promise<T[]> {
  const transaction = (await database()).transaction("own", mode);
  const all = requests(transaction.objectStore("own"));
  await new Promise<void>((resolve, reject) => {
    transaction.oncomplete = () => resolve();
    transaction.onabort = () => reject(transaction.error);
  });
  return all.map(({ result }) => result);
}

export const ownIds = () => ask("own", "readonly", (store) => store.getAllKeys() as IDBRequest<string[]>);
export const ownTextures = (ids: readonly string[]) => askAll<Own | undefined>("readonly", (store) => ids.map((id) => store.get(id)));
/** Keeps textures, all or none. */
export const keepOwn = (own: readonly Own[]) => askAll("readwrite", (store) => own.map((one) => store.put(one)));
export const forgetOwn = (id: string) => ask("own", "readwrite", (store) => store.delete(id));
export const lastWork = <T>() => ask<T | undefined>("session", "readonly", (store) => store.get("work"));
export const keepWork = (work: unknown) => ask("session", "readwrite", (store) => store.put(work, "work"));
