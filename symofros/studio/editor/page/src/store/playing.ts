/** The time that plots and the 3-D view stand at, and its course while a motion plays. */

import type { Analysed, Ran, Simulated } from "../api/jobs";
import { now, update } from "./store";
import { seek, shownBlock } from "./view";

// What the clock can be slowed down and sped up to.
export const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5] as const;

/** The newest motion: of the diagram's run, of the analysis whose result is shown, else of the simulation. */
function newest(): { id: string; t: number[]; block: string } | null {
  const { document, jobs, bottom, shape } = now();
  const isAnalysis = bottom === "analyse" && jobs.analyse?.state === "done";
  const job = document?.diagram ? jobs.run : isAnalysis ? jobs.analyse : jobs.simulate;
  if (job?.state !== "done") return null;
  if (job.kind === "simulate") return { id: job.id, t: (job.result as Simulated).t, block: "" };
  const { motions } = job.result as Ran | Analysed;
  const block = job.kind === "run" ? shownBlock() : shownMotion(motions, shape);
  const t = motions[block]?.t;
  return t === undefined ? null : { id: job.id, t, block };
}

/** The name of the motion that is chosen, of those that an analysis has. */
export const shownMotion = (motions: Analysed["motions"], shape: string): string =>
  shape in motions ? shape : (Object.keys(motions)[0] ?? "");

/** Puts the cursor of all plots, the slider and the 3-D view to a time [s]. */
export function setTime(time: number): void {
  update({ time });
  const run = newest();
  if (run !== null && now().right === "view") seek(run.id, time, run.block);
}

/** Shows the motion's state in the 3-D view, which opens. */
export function showMotion(): void {
  update({ right: "view", time: newest()?.t[0] ?? 0 });
  setTime(now().time ?? 0);
}

export function pause(): void {
  update({ playing: false });
}

/** Plays the motion from where it stands, from its beginning if it is at its end; the 3-D view opens. */
export function play(): void {
  const run = newest();
  const [start, end] = [run?.t[0] ?? 0, run?.t.at(-1) ?? 0];
  if (run === null || end <= start) return;
  const { time } = now();
  const from = time === null || time >= end || time < start ? start : time;
  update({ playing: true, time: from, right: "view" });
  let last = performance.now();
  const next = (clock: number): void => {
    if (!now().playing) return;
    if (newest()?.id !== run.id) {
      pause();
      return;
    }
    // The picture is derived when its pane opens; the motion waits for it.
    if (now().view === null) last = clock;
    const moved = (now().time ?? start) + (now().speed * Math.max(0, clock - last)) / 1000;
    last = clock;
    setTime(Math.min(moved, end));
    if (moved < end) requestAnimationFrame(next);
    else pause();
  };
  requestAnimationFrame(next);
}
