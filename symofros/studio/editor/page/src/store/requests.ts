/** One request after another, so that each carries the newest revision; refusals become notices. */

import { Refused, Unreachable } from "../api/client";
import type { Document } from "../api/types";
import { completedDiagram } from "../model/diagram_layout";
import { elementIds } from "../model/elements";
import { completed } from "../model/layout";
import { NO_MOVES } from "../model/moves";
import { notify, now, update } from "./store";

let queue: Promise<unknown> = Promise.resolve();
let waiting = 0;

export function accept(document: Document): void {
  const old = now().document;
  // Another file, or a new start: what was chosen in the old one means nothing here.
  const fresh = old === null || old.path !== document.path;
  const { graph, diagram } = document;
  const ids = elementIds(document);
  update((state) => ({
    document,
    // Blocks that nobody has put stay where they were first shown.
    places:
      diagram === null
        ? completed(graph, fresh ? document.layout : state.places, document.layout)
        : completedDiagram(diagram, fresh ? document.layout : state.places, document.layout),
    moves: fresh ? NO_MOVES : state.moves,
    folded: fresh ? [] : state.folded,
    filter: fresh ? "" : state.filter,
    selected: fresh
      ? []
      : state.selected.every((id) => ids.has(id))
        ? state.selected
        : state.selected.filter((id) => ids.has(id)),
    jobs: fresh ? {} : state.jobs,
    live: fresh ? null : state.live,
    runs: fresh ? [] : state.runs,
    time: fresh ? null : state.time,
    playing: fresh ? false : state.playing,
    bottom: fresh && state.bottom !== "problems" ? null : state.bottom,
  }));
}

export const busy = (): boolean => waiting > 0;

/** Says what went wrong; true if the request is answered. */
export function explain(reason: unknown): void {
  if (reason instanceof Unreachable) update({ link: "lost" });
  else if (reason instanceof Refused && reason.status === 401) update({ link: "expired" });
  else if (reason instanceof Refused) notify(reason.fault);
  else throw reason;
}

/** Runs `ask` when all earlier ones are answered. Undefined if it was refused and `refused` did not help. */
export function ordered<T>(
  ask: () => Promise<T>,
  refused?: (refusal: Refused) => Promise<T | undefined>,
): Promise<T | undefined> {
  const attempt = async (): Promise<T | undefined> => {
    try {
      return await ask();
    } catch (reason) {
      if (reason instanceof Refused && refused !== undefined) return refused(reason);
      explain(reason);
      return undefined;
    }
  };
  waiting += 1;
  const answer = queue.then(attempt).finally(() => {
    waiting -= 1;
  });
  queue = answer.catch(() => undefined);
  return answer;
}
