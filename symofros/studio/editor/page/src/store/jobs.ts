/** Long work of the server: start, follow, cancel. */

import { get, post, type Refused, remove } from "../api/client";
import type { Job, JobKind, Samples } from "../api/jobs";
import type { NativeFile } from "../api/types";
import { withRun } from "../model/runs";
import { setTime } from "./playing";
import { explain, ordered } from "./requests";
import { now, show, update } from "./store";
import { settle } from "./unsent";

const PERIOD = 1000;

/** What an event says of a job; its result is fetched. */
export function hear(job: Job): void {
  const { document, jobs } = now();
  const known = jobs[job.kind];
  if (known?.id === job.id) {
    if (job.state === "running") take(job);
    else void fetchJob(job.id);
  } else if (job.state === "running" && known?.state !== "running" && job.path === document?.path) {
    // Another page, or this one before it was loaded again, has started it: it can be cancelled here, too.
    take(job);
    void follow(job.kind, job.id);
  }
}

/** What a run tells while it goes on; its first words may come before the answer that names the run. */
export function hearSamples({ id, plots, t, values }: Samples): void {
  const known = now().jobs.run;
  if (known?.state === "running" && known.id !== id) return; // Another page's run.
  if (plots !== null) {
    const names = [...new Set(plots.flatMap(({ curves }) => curves.map(({ name }) => name)))];
    update({ live: { id, plots, t: [], values: Object.fromEntries(names.map((name) => [name, []])) } });
    return;
  }
  const { live } = now();
  if (live === null || live.id !== id) return;
  const longer = Object.entries(live.values).map(([name, before], i): [string, (number | null)[]] => [
    name,
    [...before, ...(values[i] ?? [])],
  ]);
  update({ live: { ...live, t: [...live.t, ...t], values: Object.fromEntries(longer) } });
}

/** Pauses a run, lets it go on, or ends it with what it has. */
export async function order(kind: JobKind, order: "pause" | "resume" | "stop"): Promise<void> {
  const job = now().jobs[kind];
  if (job !== undefined) await ordered(() => post(`api/jobs/${job.id}`, { order }));
}

async function fetchJob(id: string): Promise<Job | undefined> {
  const job = await get<Job>(`api/jobs/${id}`).catch(explain);
  // Of a document that was left meanwhile nothing is shown in another one.
  if (job !== undefined && now().jobs[job.kind]?.id === id) take(job);
  return job ?? undefined;
}

function take(job: Job): void {
  const known = now().jobs[job.kind];
  // Answers and events cross: one that was sent before the end brings nothing new after it.
  if (known?.id === job.id && known.state !== "running") return;
  const moves = job.kind === "simulate" || job.kind === "run" || job.kind === "analyse";
  const isNew = moves && job.state === "done";
  update((state) => ({ jobs: { ...state.jobs, [job.kind]: job }, runs: withRun(state.runs, job) }));
  const { time } = now();
  if (isNew && time !== null) setTime(time);
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

// What is asked and not answered yet: a double click asks once.
const starting = new Set<string>();

export async function run(kind: JobKind, options: object = {}): Promise<void> {
  const key = JSON.stringify([kind, options]);
  if (starting.has(key)) return;
  starting.add(key);
  const id = await start(kind, options).finally(() => starting.delete(key));
  if (id !== undefined) await follow(kind, id);
}

/** The id of a job that is started, and shown; undefined where it is not. */
async function start(kind: JobKind, options: object): Promise<string | undefined> {
  const path = now().document?.path;
  await settle();
  const asked = async (refused: Refused): Promise<undefined> => {
    const { native } = refused.body;
    if (native === undefined) explain(refused);
    else show({ kind: "consent", files: native, fault: refused.fault, proceed: () => void run(kind, options) });
    return undefined;
  };
  const started = await ordered(
    async () => (now().document?.path === path ? post<{ id: string }>("api/jobs", { kind, options }) : undefined),
    asked,
  );
  if (started === undefined || path === undefined || now().document?.path !== path) return undefined;
  take({
    id: started.id,
    kind,
    revision: now().document?.revision ?? 0,
    path,
    state: "running",
    progress: { done: 0, total: 0, text: "" },
    result: null,
    error: null,
  });
  update(({ live }) => ({ bottom: kind, live: live?.id === started.id ? live : null }));
  return started.id;
}

/** Consents to the native code of files, as they were shown; whether the server took it. */
export async function consent(files: readonly NativeFile[]): Promise<boolean> {
  const given = files.map(({ path, digest }) => ({ path, digest }));
  return (await ordered(() => post("api/consent", { files: given }))) !== undefined;
}

export async function cancel(kind: JobKind): Promise<void> {
  const job = now().jobs[kind];
  if (job === undefined) return;
  await ordered(() => remove(`api/jobs/${job.id}`));
}
