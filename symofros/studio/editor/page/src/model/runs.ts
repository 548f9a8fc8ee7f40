/** Runs that are kept to be compared: each with its name, and whether its curves are drawn. */

import type { Job, JobKind } from "../api/jobs";

export interface KeptRun {
  /** Of its job. */
  id: string;
  kind: JobKind;
  name: string;
  /** Revision of the document that it is of. */
  revision: number;
  shown: boolean;
  result: unknown;
}

// As many curves as can be told apart; the server keeps twenty jobs.
const MOST = 8;

/** The runs with one more, which is not drawn twice while it is the newest. */
export function withRun(runs: readonly KeptRun[], job: Job): readonly KeptRun[] {
  if (job.state !== "done" || (job.kind !== "simulate" && job.kind !== "run")) return runs;
  if (runs.some(({ id }) => id === job.id)) return runs;
  const numbers = runs.map(({ name }) => Number(/^run (\d+)$/.exec(name)?.[1] ?? 0));
  const name = `run ${Math.max(runs.length, ...numbers) + 1}`;
  const run = { id: job.id, kind: job.kind, name, revision: job.revision, shown: false, result: job.result };
  return [...runs, run].slice(-MOST);
}

/** Others of a kind than the newest, whose curves are drawn with its own. */
export const overlaid = (runs: readonly KeptRun[], kind: JobKind, newest: string | undefined): KeptRun[] =>
  runs.filter((run) => run.kind === kind && run.shown && run.id !== newest);

/** The record after (or before) a time, of times that rise; the last (or first) where there is none. */
export function neighbour(t: readonly number[], at: number, by: 1 | -1): number {
  const found = by === 1 ? t.find((each) => each > at) : t.findLast((each) => each < at);
  return found ?? (by === 1 ? t.at(-1) : t[0]) ?? at;
}
