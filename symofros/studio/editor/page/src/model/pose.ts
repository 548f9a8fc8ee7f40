/** Requests that move the 3-D view: which of them still hold when a later one comes. */

import type { Pose, View } from "../api/types";

/** What of a pose is no state: colours, marks, frames, a handle. It holds whatever state comes after. */
function looksOf(pose: Pose): Pose {
  const { q: _q, par: _par, run: _run, t: _t, block: _block, reset: _reset, ...looks } = pose;
  return looks;
}

/** A pose after one that waits, as one that says both; of a run's instant, a reset and the sliders the later one holds. */
export function merged(waiting: Pose | null, pose: Pose): Pose {
  if (waiting === null) return pose;
  const isOfRun = waiting.run !== undefined || pose.run !== undefined;
  if (isOfRun || pose.reset === true) return { ...looksOf(waiting), ...pose };
  return { ...waiting, ...pose, q: { ...waiting.q, ...pose.q }, par: { ...waiting.par, ...pose.par } };
}

/** A pose as the server takes it: looks, and the instant of a run, in requests of their own. */
export function requestsOf(pose: Pose): Pose[] {
  const { run, t, block } = pose;
  if (run === undefined) return [pose];
  const looks = looksOf(pose);
  const instant: Pose = { run, ...(t === undefined ? {} : { t }), ...(block === undefined ? {} : { block }) };
  return Object.keys(looks).length > 0 ? [looks, instant] : [instant];
}

/** Where the sliders and boxes of a view stand while a pose that they asked for is not answered: where they were put. */
export function expected(view: View, asked: Pose): View {
  const { q, exaggeration = view.exaggeration, frames = view.frames, forces = view.forces } = asked;
  return { ...view, q: { ...view.q, ...q }, exaggeration, frames, forces };
}
