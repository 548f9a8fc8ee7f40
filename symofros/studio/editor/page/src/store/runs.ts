/** Kept runs: renamed, drawn or not, forgotten, saved as a file. */

import { download } from "../api/client";
import type { KeptRun } from "../model/runs";
import { explain } from "./requests";
import { update } from "./store";

function change(id: string, by: Partial<KeptRun>): void {
  update((state) => ({ runs: state.runs.map((run) => (run.id === id ? { ...run, ...by } : run)) }));
}

export const rename = (id: string, name: string): void => change(id, { name });
export const draw = (id: string, shown: boolean): void => change(id, { shown });
export const forget = (id: string): void => update((state) => ({ runs: state.runs.filter((run) => run.id !== id) }));

/** Hands the run's columns to the browser as a file. */
export async function saveTable(run: KeptRun, suffix: "csv" | "parquet"): Promise<void> {
  const content = await download(`api/jobs/${run.id}/table.${suffix}`).catch(explain);
  if (content === undefined) return;
  const link = window.document.createElement("a");
  link.href = URL.createObjectURL(content);
  link.download = `${run.name.replaceAll(/\W+/g, "_")}.${suffix}`;
  link.click();
  window.setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}
