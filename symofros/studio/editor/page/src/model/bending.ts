/** Words on how far beams are bent, and what their theory errs there. */

import type { BentBeam, Job, Ran, Simulated } from "../api/jobs";
import { brief } from "./plot";

const LEAST = 1e-4;

/** An error in per cent, with the figures that the sentences of runs give it. */
export function percent(error: number | null): string {
  if (error === null) return "beyond its critical load";
  if (error < LEAST) return `below ${100 * LEAST} %`;
  return `${Number((100 * error).toFixed(error < 0.001 ? 2 : error < 0.1 ? 1 : 0))} %`;
}

/** A number of an estimate. */
export const rough = (value: number): string => String(Number(value.toPrecision(2)));

/** What a block has room for; "" where nothing bends. */
export const badge = (bent: BentBeam): string =>
  (bent.slope ?? 1) === 0 ? "" : bent.error === null ? "unstable" : `± ${percent(bent.error).replace("below", "<")}`;

/** Of a beam in segments, which are called b, b.2, b.3: the whole. */
const whole = (name: string): string => name.replace(/\.\d+$/, "");

/** The largest bending of each beam in the newest simulation, as long as the model is still that of the run. */
export function bentBy(job: Job | undefined, revision: number): ReadonlyMap<string, BentBeam> {
  const beams = job?.state === "done" && job.revision === revision ? (job.result as Simulated | Ran).beams : [];
  const worst = (one: BentBeam): number => one.error ?? Infinity;
  return new Map([...beams].sort((a, b) => worst(a) - worst(b)).map((bent) => [whole(bent.beam), bent]));
}

/** Where along the beam, and when. */
export const where = ({ station, t }: BentBeam): string =>
  `x = ${brief(station)} m${t === null ? "" : `, t = ${brief(t)} s`}`;

/** Roots of 1 + cos(b) cosh(b) = 0, as in symofros/studio/editor/document/figures/beam_figures.py. */
const ROOTS = [1.875104068711961, 4.694091132974174, 7.854757438237612];

/** Deflection of a uniform cantilever in one of its first three vibrations at x/L; 2 at its tip, or -2. */
export function cantilever(mode: number, xi: number): number {
  const b = ROOTS[mode] ?? 0;
  const ratio = (Math.cosh(b) + Math.cos(b)) / (Math.sinh(b) + Math.sin(b));
  return Math.cosh(b * xi) - Math.cos(b * xi) - ratio * (Math.sinh(b * xi) - Math.sin(b * xi));
}
