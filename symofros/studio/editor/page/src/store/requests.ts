/** One request after another, so that each carries the newest revision; refusals become notices. */

import { Refused, Unreachable } from "../api/client";
import type { Document } from "../api/types";
import { completedDiagram } from "../model/diagram_layout";
import { elementIds } from "../model/elements";
import { completed } from "../model/layout";
import { type Dialog, notify, now, OF_NEW_DOCUMENT, type State, update } from "./store";

let queue: Promise<unknown> = Promise.resolve();

/** More blocks than these take a browser minutes to draw, and nobody can read them. */
export const MOST_DRAWN = 1500;

/** The document without blocks where they are too many; `undrawn` is their number. */
function drawable(document: Document): Document {
  const { graph, diagram } = document;
  const count = graph.nodes.length + (diagram?.nodes.length ?? 0);
  if (count <= MOST_DRAWN) return { ...document, undrawn: 0 };
  const none = { nodes: [] };
  return {
    ...document,
    undrawn: count,
    graph: { ...none, edges: [] },
    diagram: diagram === null ? null : { ...diagram, ...none, wires: [] },
  };
}

/** Windows about the open document; the others are about none, such as the list of files. */
const OF_DOCUMENT: readonly Dialog["kind"][] = [
  "properties",
  "save as",
  "simulate",
  "analyse",
  "run",
  "consent",
  "export",
  "save part",
  "link",
  "discard",
  "changed on disk",
];

const isOfDocument = ({ dialog }: State): boolean => dialog !== null && OF_DOCUMENT.includes(dialog.kind);

/** What is kept when the same document goes on: all that still exists in it. */
function kept(state: State, document: Document): Partial<State> {
  const ids = elementIds(document);
  const isGone = !state.selected.every((id) => ids.has(id));
  return isGone ? { selected: state.selected.filter((id) => ids.has(id)) } : {};
}

/**
 * Makes a document the one that is shown.
 *
 * Of another document than before nothing is kept that is known of that one: its windows are closed, its runs, its
 * selection, its picture are gone. `isRenamed`: it is the same one at another path.
 */
export function accept(answered: Document, isRenamed = false): void {
  const document = drawable(answered);
  const old = now().document;
  const fresh = old === null || (old.path !== document.path && !isRenamed);
  const { graph, diagram } = document;
  update((state) => {
    const shown = fresh ? document.layout : state.places;
    return {
      ...(fresh ? OF_NEW_DOCUMENT : kept(state, document)),
      document,
      // Blocks that nobody has put stay where they were first shown.
      places:
        diagram === null ? completed(graph, shown, document.layout) : completedDiagram(diagram, shown, document.layout),
      ...(fresh && old !== null && isOfDocument(state) ? { dialog: null } : {}),
      ...(fresh ? panes(state, document) : {}),
    };
  });
}

/** What stands beside a document that was just opened: the text of one of which nothing can be drawn. */
function panes({ bottom }: State, { problems, data, undrawn }: Document): Partial<State> {
  if (undrawn > 0) return { right: "text", bottom: bottom === "problems" ? bottom : null };
  if (problems.length > 0 && Object.keys(data).length === 0) return { right: "text", bottom: "problems" };
  return { bottom: bottom === "problems" ? bottom : null };
}

/** As `accept`, of a document that somebody else may have opened: what is closed by it is said. */
export function acceptTheirs(document: Document): void {
  const { document: old } = now();
  const isLost = old !== null && old.path !== document.path && isOfDocument(now());
  accept(document);
  if (isLost)
    notify({
      object: document.path,
      found: `another page has opened it while a window of ${old.path} was open here`,
      rule: "the pages of one server show one document; what is typed for one is not taken for another",
      remedy: `the window was closed: open ${old.path} again, and repeat what it should change`,
    });
}

/** Says what went wrong; true if the request is answered. */
export function explain(reason: unknown): void {
  if (reason instanceof Unreachable) update({ link: "lost" });
  else if (reason instanceof Refused && reason.status === 401) update({ link: "expired" });
  else if (reason instanceof Refused) notify(reason.fault);
  else throw reason;
}

/** Waits until all that was asked before is answered, and the document is what came of it. */
export const answered = (): Promise<void> => ordered(() => Promise.resolve());

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
  const answer = queue.then(attempt);
  queue = answer.catch(() => undefined);
  return answer;
}
