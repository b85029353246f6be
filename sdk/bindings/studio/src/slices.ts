// Long work in short slices, between which the page draws and answers.

/** Longest slice, ms: half of a frame at 60 Hz. */
const SLICE_MS = 8;

// Timers would wait 4 ms each time, and a second in a page that is not seen.
const channel = new MessageChannel();
const next: (() => void)[] = [];
channel.port1.onmessage = () => next.shift()?.();

function nextTask() {
  return new Promise<void>((resolve) => {
    next.push(resolve);
    channel.port2.postMessage(null);
  });
}

let began = 0;

/** Waits for the next slice if this one is full. */
export async function breathe() {
  if (performance.now() - began < SLICE_MS) return;
  await nextTask();
  began = performance.now();
}

const jobs = new Set<() => Promise<unknown>>();
let isBusy = false;

async function work() {
  isBusy = true;
  for (const job of jobs) {
    jobs.delete(job);
    await breathe();
    await job();
  }
  isBusy = false;
}

/** Runs a job in a slice, after those that wait already. The function that is returned takes the job back. */
export function whenFree(job: () => Promise<unknown>) {
  jobs.add(job);
  if (!isBusy) void work();
  return () => void jobs.delete(job);
}
