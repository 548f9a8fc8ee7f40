/** The time that plots and the 3-D view stand at, and its course while a motion plays. */

import type { Simulated } from "../api/jobs";
import { now, update } from "./store";
import { seek } from "./view";

// What the clock can be slowed down and sped up to.
export const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5] as const;

/** The newest simulation, if it has a result. */
function simulation(): { id: string; result: Simulated } | null {
  const job = now().jobs.simulate;
  return job?.state === "done" ? { id: job.id, result: job.result as Simulated } : null;
}

/** Puts the cursor of all plots, the slider and the 3-D view to a time [s]. */
export function setTime(time: number): void {
  update({ time });
  const run = simulation();
  if (run !== null && now().right === "view") seek(run.id, time);
}

export function pause(): void {
  update({ playing: false });
}

/** Plays the motion from where it stands, from its beginning if it is at its end; the 3-D view opens. */
export function play(): void {
  const run = simulation();
  const [start, end] = [run?.result.t[0] ?? 0, run?.result.t.at(-1) ?? 0];
  if (run === null || end <= start) return;
  const { time } = now();
  const from = time === null || time >= end || time < start ? start : time;
  update({ playing: true, time: from, right: "view" });
  let last = performance.now();
  const next = (clock: number): void => {
    if (!now().playing) return;
    if (simulation()?.id !== run.id) {
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
