// What stays on this device: own textures, and the work of last time.

const DATABASE = "htex-studio";
const VERSION = 1;

export interface Own {
  readonly id: string;
  readonly name: string;
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

export const ownTextures = () => ask<Own[]>("own", "readonly", (store) => store.getAll());
export const keepOwn = (own: Own) => ask("own", "readwrite", (store) => store.put(own));
export const forgetOwn = (id: string) => ask("own", "readwrite", (store) => store.delete(id));
export const lastWork = <T>() => ask<T | undefined>("session", "readonly", (store) => store.get("work"));
export const keepWork = (work: unknown) => ask("session", "readwrite", (store) => store.put(work, "work"));
