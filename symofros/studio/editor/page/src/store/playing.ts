/** The time that plots and the 3-D view stand at, and its course while a motion plays. */

import type { Ran, Simulated } from "../api/jobs";
import { now, update } from "./store";
import { seek, shownBlock } from "./view";

// What the clock can be slowed down and sped up to.
export const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5] as const;

/** The times of the newest motion: of the simulation, or of the diagram's run, if it has a result. */
function newest(): { id: string; t: number[] } | null {
  const { document, jobs } = now();
  const job = document?.diagram ? jobs.run : jobs.simulate;
  if (job?.state !== "done") return null;
  const t = job.kind === "run" ? (job.result as Ran).motions[shownBlock()]?.t : (job.result as Simulated).t;
  return t === undefined ? null : { id: job.id, t };
}

/** Puts the cursor of all plots, the slider and the 3-D view to a time [s]. */
export function setTime(time: number): void {
  update({ time });
  const run = newest();
  if (run !== null && now().right === "view") seek(run.id, time);
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
