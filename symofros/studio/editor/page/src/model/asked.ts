/** What the windows of runs were asked: texts as they were typed, by the names that they are of. */

export type Texts = Readonly<Record<string, string>>;

export interface AskedSimulation {
  end: string;
  step: string;
  tolerance: string;
  method: string;
  q0: Texts;
  v0: Texts;
  inputs: Texts;
  events: readonly AskedEvent[];
  stopAtLimits: boolean;
}

/** A formula whose zeros are found. */
export interface AskedEvent {
  name: string;
  formula: string;
  direction: "both" | "rising" | "falling";
  terminal: boolean;
}

export interface AskedAnalysis {
  what: string;
  about: "equilibrium" | "pose";
  /** Inputs as numbers. */
  u: Texts;
  /** Speeds whose coordinates stay. */
  held: readonly string[];
  /** Of a sweep: what is drawn over which parameter, from where to where at how many values. */
  of: "frequencies" | "motion";
  parameter: string;
  low: string;
  high: string;
  count: string;
  /** Of advice: what of the motion matters, and the error that does no harm. */
  outputs: readonly AskedOutput[];
}

export interface AskedOutput {
  kind: "position" | "coordinate" | "speed";
  of: string;
  absolute: string;
}

export interface AskedRun {
  mode: "compiled" | "interpreted";
  /** "" leaves it to the file; the others too. */
  end: string;
  step: string;
  method: string;
  pace: string;
  stops: string;
}

export const FIRST_SIMULATION: AskedSimulation = {
  end: "5",
  step: "0.001",
  tolerance: "1e-8",
  method: "rk4",
  q0: {},
  v0: {},
  inputs: {},
  events: [],
  stopAtLimits: false,
};

export const FIRST_ANALYSIS: AskedAnalysis = {
  what: "equilibrium",
  about: "equilibrium",
  u: {},
  held: [],
  of: "frequencies",
  parameter: "",
  low: "",
  high: "",
  count: "5",
  outputs: [],
};

export const FIRST_RUN: AskedRun = { mode: "compiled", end: "", step: "", method: "", pace: "", stops: "" };

/** Those that say something. */
const stated = (texts: Texts): [string, string][] => Object.entries(texts).filter(([, text]) => text.trim() !== "");

/** Texts of names that there are. */
export const known = (texts: Texts, names: readonly string[]): Record<string, string> =>
  Object.fromEntries(stated(texts).filter(([name]) => names.includes(name)));

/** Texts of names that there are no more. */
export const strangers = (texts: Texts, names: readonly string[]): Record<string, string> =>
  Object.fromEntries(stated(texts).filter(([name]) => !names.includes(name)));

/** The name that renaming has given to a name; `before` and `after` are all names in order. */
export function newName(before: readonly string[], after: readonly string[]): (name: string) => string {
  if (before.length !== after.length) return (name) => name;
  const renamed = new Map(before.map((name, i) => [name, after[i] ?? name]));
  return (name) => renamed.get(name) ?? name;
}

/** Texts under new names. */
export const followed = (texts: Texts, renamed: (name: string) => string): Texts =>
  Object.fromEntries(Object.entries(texts).map(([name, text]) => [renamed(name), text]));
