// What knobs and drawing may change: the handles that are not locked, within a range of frequencies. Both belong to the texture that was
// opened; another texture begins without them.

import { computed, signal } from "@preact/signals";

import { origin } from "../state.ts";
import { NO_LIMITS, type Limits, type Range } from "./shaper.ts";
import { handles, model } from "./subject.ts";

interface Locks {
  readonly origin: string | undefined;
  readonly model: string | null;
  /** Number of handles. If undo changes it, the indices mean other handles. */
  readonly count: number;
  readonly of: ReadonlySet<number>;
}

const locks = signal<Locks | null>(null);
const chosen = signal<{ readonly origin: string | undefined; readonly range: Range } | null>(null);

const isSubject = (one: Locks) => one.origin === origin.value?.id && one.model === model.value && one.count === handles.value.length;

const locked = computed(() => (locks.value && locks.value.of.size > 0 && isSubject(locks.value) ? locks.value.of : NO_LIMITS.locked));
const range = computed(() => (chosen.value && chosen.value.origin === origin.value?.id ? chosen.value.range : null));

export const limits = computed<Limits>(() => (locked.value.size > 0 || range.value ? { locked: locked.value, range: range.value } : NO_LIMITS));

/** Changes whenever the user sets other limits. */
export const limitsSet = computed(() => [locks.value, chosen.value]);

/** Locks handles of the present curve, and no others. */
export function lock(of: Iterable<number>) {
  locks.value = { origin: origin.peek()?.id, model: model.peek(), count: handles.peek().length, of: new Set(of) };
}

export function toggleLock(handle: number) {
  const now = [...locked.peek()];
  lock(now.includes(handle) ? now.filter((one) => one !== handle) : [...now, handle]);
}

/** Limits changes to a range; null for all frequencies. */
export function setRange(to: Range | null) {
  chosen.value = to && { origin: origin.peek()?.id, range: to };
}

export function removeLimits() {
  locks.value = null;
  chosen.value = null;
}
