/** Long work of the server: start, follow, cancel. */

import { get, post, remove } from "../api/client";
import type { Job, JobKind } from "../api/jobs";
import { explain, ordered } from "./requests";
import { now, update } from "./store";

const PERIOD = 1000;

/** What an event says of a job; its result is fetched. */
export function hear(job: Job): void {
  if (now().jobs[job.kind]?.id !== job.id) return;
  if (job.state === "running") take(job);
  else void fetchJob(job.id);
}

async function fetchJob(id: string): Promise<Job | undefined> {
  const job = await get<Job>(`api/jobs/${id}`).catch(explain);
  if (job !== undefined) take(job);
  return job ?? undefined;
}

function take(job: Job): void {
  update((state) => ({ jobs: { ...state.jobs, [job.kind]: job } }));
}

/** Asks now and then; the server tells too, but a stream of events can break. */
async function follow(kind: JobKind, id: string): Promise<void> {
  for (;;) {
    await new Promise((resolve) => window.setTimeout(resolve, PERIOD));
    const known = now().jobs[kind];
    if (known?.id !== id || known.state !== "running") return;
    if ((await fetchJob(id)) === undefined) return;
  }
}

export async function run(kind: JobKind, options: object = {}): Promise<void> {
  const started = await ordered(() => post<{ id: string }>("api/jobs", { kind, options }));
  if (started === undefined) return;
  take({
    id: started.id,
    kind,
    revision: now().document?.revision ?? 0,
    state: "running",
    progress: { done: 0, total: 0, text: "" },
    result: null,
    error: null,
  });
  update({ bottom: kind });
  await follow(kind, started.id);
}

export async function cancel(kind: JobKind): Promise<void> {
  const job = now().jobs[kind];
  if (job === undefined) return;
  await ordered(() => remove(`api/jobs/${job.id}`));
}
