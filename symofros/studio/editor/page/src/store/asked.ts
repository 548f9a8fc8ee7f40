/** What windows of runs were asked last, kept by document. */

import type { Document } from "../api/types";
import {
  type AskedAnalysis,
  type AskedRun,
  type AskedSimulation,
  FIRST_ANALYSIS,
  FIRST_RUN,
  FIRST_SIMULATION,
  followed,
  known,
  newName,
} from "../model/asked";
import { inputs, rates, startNumbers, starts } from "../model/motion";
import { allFrames } from "../model/names";
import { now, show, update } from "./store";

const here = (): string => now().document?.path ?? "";

/** What was asked of the open document last, or what one begins with. */
export const askedSimulation = (): AskedSimulation => now().asked.simulate[here()] ?? FIRST_SIMULATION;
export const askedRun = (): AskedRun => now().asked.run[here()] ?? FIRST_RUN;

const numbers = (texts: Record<string, string>): Record<string, number> =>
  Object.fromEntries(Object.entries(texts).map(([name, text]) => [name, Number(text)]));
const named = (rows: readonly { name: string }[]): string[] => rows.map(({ name }) => name);

/** Whether a method of simulation chooses its steps by a tolerance. */
export const isAdaptive = (method: string): boolean =>
  now().catalogue?.methods.find(({ name }) => name === method)?.adaptive === true;

/** What a simulation is asked of the server: start and method, to which the motion's end, inputs and events belong. */
export function simulationOptions(asked: AskedSimulation): {
  from: { method: string; q0: Record<string, number>; v0: Record<string, number> };
  course: object;
} {
  const data = now().document?.data ?? {};
  const { end, step, tolerance, method, events, stopAtLimits } = asked;
  const accuracy = isAdaptive(method) ? { rtol: Number(tolerance) } : { dt: Number(step) };
  const q0 = startNumbers(data, known(asked.q0, named(starts(data))));
  const v0 = numbers(known(asked.v0, named(rates(data))));
  const laws = known(asked.inputs, named(inputs(data)));
  return {
    from: { method, ...accuracy, q0, v0 },
    course: { t_end: Number(end), inputs: laws, events, stop_at_limits: stopAtLimits },
  };
}

export const askedAnalysis = (): AskedAnalysis => now().asked.analyse[here()] ?? FIRST_ANALYSIS;

export function keepAnalysis(last: AskedAnalysis): void {
  update(({ asked }) => ({ asked: { ...asked, analyse: { ...asked.analyse, [here()]: last } } }));
}

export function keepSimulation(last: AskedSimulation): void {
  update(({ asked }) => ({ asked: { ...asked, simulate: { ...asked.simulate, [here()]: last } } }));
}

export function keepRun(last: AskedRun): void {
  update(({ asked }) => ({ asked: { ...asked, run: { ...asked.run, [here()]: last } } }));
}

/** Opens the window of simulations, or of analyses, with what was asked last. */
export const showSimulation = (): void => show({ kind: "simulate", asked: askedSimulation() });
export const showAnalysis = (): void => show({ kind: "analyse", asked: askedAnalysis(), state: askedSimulation() });

/**
 * What was asked goes with the names that an edit has changed, in a window that is open, too: it may have been opened
 * before the edit was answered.
 */
export function followRenaming(before: Document): void {
  const { document, dialog } = now();
  if (document === null || document.path !== before.path) return;
  const along = (names: (document: Document) => string[]) => newName(names(before), names(document));
  const coordinate = along(({ data }) => named(starts(data)));
  const speed = along(({ data }) => named(rates(data)));
  const input = along(({ data }) => named(inputs(data)));
  const parameter = along(({ parameters }) => named(parameters));
  const renamed = { coordinate, speed, position: along(({ data }) => allFrames(data)) };
  const simulation = (asked: AskedSimulation): AskedSimulation => ({
    ...asked,
    q0: followed(asked.q0, coordinate),
    v0: followed(asked.v0, speed),
    inputs: followed(asked.inputs, input),
  });
  const analysis = (asked: AskedAnalysis): AskedAnalysis => ({
    ...asked,
    u: followed(asked.u, input),
    held: asked.held.map(speed),
    parameter: parameter(asked.parameter),
    outputs: asked.outputs.map((output) => ({ ...output, of: renamed[output.kind](output.of) })),
  });
  keepSimulation(simulation(askedSimulation()));
  keepAnalysis(analysis(askedAnalysis()));
  if (dialog?.kind === "simulate") show({ ...dialog, asked: simulation(dialog.asked) });
  if (dialog?.kind === "analyse") show({ ...dialog, asked: analysis(dialog.asked), state: simulation(dialog.state) });
}

/** What was asked of a document goes with it to another path. */
export function followPath(from: string, to: string): void {
  update(({ asked }) => {
    const { [from]: simulate = FIRST_SIMULATION } = asked.simulate;
    const { [from]: run = FIRST_RUN } = asked.run;
    const { [from]: analyse = FIRST_ANALYSIS } = asked.analyse;
    return {
      asked: {
        simulate: { ...asked.simulate, [to]: simulate },
        run: { ...asked.run, [to]: run },
        analyse: { ...asked.analyse, [to]: analyse },
      },
    };
  });
}
