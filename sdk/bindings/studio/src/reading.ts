// A worker that reads recordings. It is asked one thing at a time, and ended where its answer is no longer wanted.

import type { Columns, Processed, RecordedLoop } from "htex";

import { compiledAuthor, startReading } from "./modules.ts";
import type { Question, Reply } from "./reading-worker.ts";

interface Answers {
  columns: Columns;
  process: Processed;
  recorded: RecordedLoop[];
}

export interface Reader {
  ask<Call extends Question["call"]>(call: Call, recordings: Question["recordings"], settings: Question["settings"]): Promise<Answers[Call]>;
  end(): void;
}

export async function reader(): Promise<Reader> {
  const module = await compiledAuthor();
  const worker = startReading();
  const ask = (call: Question["call"], recordings: Question["recordings"], settings: Question["settings"]) =>
    new Promise<never>((resolve, reject) => {
      worker.onmessage = ({ data }: MessageEvent<Reply>) => ("problem" in data ? reject(new Error(data.problem)) : resolve(data.answer as never));
      worker.onerror = ({ message }) => reject(new Error(`the worker that reads recordings failed: ${message}`));
      worker.postMessage({ module, question: { call, recordings, settings } satisfies Question });
    });
  return { ask, end: () => worker.terminate() };
}
