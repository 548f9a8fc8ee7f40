/** What windows of runs were asked last, kept by document. */

import type { Document } from "../api/types";
import { type AskedRun, type AskedSimulation, FIRST_RUN, FIRST_SIMULATION, followed } from "../model/asked";
import { inputs, rates, starts } from "../model/motion";
import { now, update } from "./store";

const here = (): string => now().document?.path ?? "";

/** What was asked of the open document last, or what one begins with. */
export const askedSimulation = (): AskedSimulation => now().asked.simulate[here()] ?? FIRST_SIMULATION;
export const askedRun = (): AskedRun => now().asked.run[here()] ?? FIRST_RUN;

export function keepSimulation(last: AskedSimulation): void {
  update(({ asked }) => ({ asked: { ...asked, simulate: { ...asked.simulate, [here()]: last } } }));
}

export function keepRun(last: AskedRun): void {
  update(({ asked }) => ({ asked: { ...asked, run: { ...asked.run, [here()]: last } } }));
}

/** Starts and laws go with coordinates and inputs that a window has renamed. */
export function followRenaming(before: Document): void {
  const [{ document }, last] = [now(), askedSimulation()];
  if (document === null || document.path !== before.path || last === FIRST_SIMULATION) return;
  const along = (texts: AskedSimulation["q0"], names: (data: Document["data"]) => string[]) =>
    followed(texts, names(before.data), names(document.data));
  keepSimulation({
    ...last,
    q0: along(last.q0, (data) => starts(data).map(({ name }) => name)),
    v0: along(last.v0, (data) => rates(data).map(({ name }) => name)),
    inputs: along(last.inputs, (data) => inputs(data).map(({ name }) => name)),
  });
}

/** What was asked of a document goes with it to another path. */
export function followPath(from: string, to: string): void {
  update(({ asked }) => {
    const { [from]: simulate = FIRST_SIMULATION } = asked.simulate;
    const { [from]: run = FIRST_RUN } = asked.run;
    return { asked: { simulate: { ...asked.simulate, [to]: simulate }, run: { ...asked.run, [to]: run } } };
  });
}
