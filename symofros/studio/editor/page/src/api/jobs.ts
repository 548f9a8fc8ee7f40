/** What the jobs of the server return. */

import type { Fault } from "./types";

export type JobKind = "compile" | "crosscheck" | "simulate" | "analyse" | "page" | "export" | "run";
export type JobState = "running" | "done" | "failed" | "cancelled";

export interface Count {
  mul: number;
  add: number;
  div: number;
  call: number;
  total: number;
}

/** A table of an analysis: a name and values a row; null where a number is not finite. */
export interface ResultTable {
  caption: string;
  head: string[];
  rows: (string | number | null)[][];
}

export interface Compiled {
  operations: Record<string, Count>;
  generate_s: number;
  compile_s: number;
  nq: number;
  nv: number;
  nu: number;
  npar: number;
  nc: number;
  /** What was chosen where several methods apply. */
  methods: ResultTable;
  notes: string[];
}

export interface Crosschecked {
  ok: boolean;
  rows: {
    quantity: string;
    engine: string;
    worst: number;
    tolerance: number;
    states: number;
    passed: boolean;
    note: string;
  }[];
  unsupported: { engine: string; quantity: string; reason: string }[];
}

export interface Series {
  name: string;
  kind: "q" | "v" | "u" | "energy";
  unit: string;
  /** Null where a run diverged. */
  values: (number | null)[];
}

/** How far a beam is bent, and what its theory errs there. */
export interface BentBeam {
  beam: string;
  /** Largest slope [rad], and its place from the root [m]; null where it is no number. */
  slope: number | null;
  station: number;
  /** Null of a pose [s]. */
  t: number | null;
  /** Of the deflection, of a geometrically exact rod of its length; null past a critical load. */
  error: number | null;
  exact: boolean;
  grade: "fine" | "noted" | "beyond";
  text: string;
  remedy: string;
}

export interface Simulated {
  t: number[];
  series: Series[];
  energy: { kinetic: (number | null)[]; potential: (number | null)[]; total: (number | null)[] };
  events: ResultTable;
  /** Each where its theory errs most. */
  beams: BentBeam[];
  outcome: { ok: boolean; t: number; reason: string; advice: string; notes: string[] };
  method: string;
  steps: number;
  wall_s: number;
}

/** Curves over something else than time, such as a parameter. */
export interface ResultPlot {
  title: string;
  x_title: string;
  unit: string;
  curves: { name: string; x: number[]; y: (number | null)[] }[];
}

/** An analysis: equilibrium, modes and the like. */
export interface Analysed {
  what: string;
  title: string;
  tables: ResultTable[];
  plots: ResultPlot[];
  /** By the names that they are chosen by. */
  motions: Record<string, { t: number[] }>;
  /** Coordinates to simulate from. */
  start: Record<string, number> | null;
  /** A model that was found, which can be opened as a document. */
  model: { name: string; text: string } | null;
  notes: string[];
  beams: BentBeam[];
}

/** A page that simulates by itself. */
export interface InPage {
  address: string;
  notes: string[];
}

export interface RunCurve {
  name: string;
  unit: string;
  /** The signal that it is an entry of. */
  signal: string;
}

export interface RunPlot<C extends RunCurve = RunCurve> {
  title: string;
  /** Whether the second curve of each signal is drawn over the first, in place of both over time. */
  xy: boolean;
  curves: C[];
}

/** A diagram's run. */
export interface Ran {
  mode: "compiled" | "interpreted";
  method: string;
  t: number[];
  plots: RunPlot<RunCurve & { values: (number | null)[] }>[];
  /** By the block that moves the mechanism. */
  motions: Record<string, { t: number[] }>;
  beams: BentBeam[];
  outcome: { ok: boolean; t: number; reason: string; advice: string; notes: string[] };
  steps: number;
  wall_s: number;
}

/** What a run tells while it goes on; the first message names the plots. */
export interface Samples {
  id: string;
  plots: RunPlot[] | null;
  t: number[];
  /** Of each name that occurs in the plots, in order. */
  values: (number | null)[][];
}

export interface Exported {
  files: string[];
  notes: string[];
}

export interface Job {
  id: string;
  kind: JobKind;
  /** Revision of the document that it is of. */
  revision: number;
  /** File of that document. */
  path: string;
  state: JobState;
  progress: { done: number; total: number; text: string; paused?: boolean };
  result: unknown;
  error: Fault | null;
}
