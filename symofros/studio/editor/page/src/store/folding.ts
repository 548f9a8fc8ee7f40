/** Folding subtrees, and moving a block into sight. */

import { blockOf } from "../model/elements";
import { loads, unfoldedFor } from "../model/folding";
import { now, update } from "./store";

/** Folds what blocks carry into them; those that are folded unfold. */
export function toggleFolds(ids: readonly string[]): void {
  const graph = now().document?.graph;
  if (graph === undefined) return;
  const carrying = loads(graph);
  const { folded } = now();
  const kept = folded.filter((id) => !ids.includes(id));
  const added = ids.filter((id) => carrying.has(id) && !folded.includes(id));
  update({ folded: [...kept, ...added] });
}

/** Chooses a block, a link or a frame, and moves it into sight, out of what is folded. */
export function reveal(id: string): void {
  const graph = now().document?.graph;
  const folded = graph === undefined ? [] : unfoldedFor(graph, now().folded, blockOf(graph, id));
  update({ selected: [id], sight: { id }, folded });
}
