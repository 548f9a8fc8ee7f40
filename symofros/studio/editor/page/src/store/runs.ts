/** Kept runs: renamed, drawn or not, forgotten, saved as a file. */

import { download } from "../api/client";
import type { KeptRun } from "../model/runs";
import { offer } from "../files/choose";
import { explain } from "./requests";
import { now, update } from "./store";
import { shownBlock, shownView } from "./view";

function change(id: string, by: Partial<KeptRun>): void {
  update((state) => ({ runs: state.runs.map((run) => (run.id === id ? { ...run, ...by } : run)) }));
}

export const rename = (id: string, name: string): void => change(id, { name });
export const draw = (id: string, shown: boolean): void => change(id, { shown });
export const forget = (id: string): void => update((state) => ({ runs: state.runs.filter((run) => run.id !== id) }));

async function save(run: KeptRun, address: string, suffix: string): Promise<void> {
  const content = await download(`api/jobs/${run.id}/${address}`).catch(explain);
  if (content !== undefined) offer(content, `${run.name.replaceAll(/\W+/g, "_")}.${suffix}`);
}

/** Hands the run's columns to the browser as a file. */
export const saveTable = (run: KeptRun, suffix: "csv" | "parquet"): Promise<void> =>
  save(run, `table.${suffix}`, suffix);

/** Hands the motion to the browser as a film: at the speed that it plays, as exaggerated as the 3-D view shows it. */
export function saveFilm(run: KeptRun, suffix: "gif" | "mp4"): Promise<void> {
  const exaggeration = shownView()?.exaggeration ?? 1;
  const block = encodeURIComponent(shownBlock());
  return save(run, `film.${suffix}?exaggeration=${exaggeration}&speed=${now().speed}&block=${block}`, suffix);
}
