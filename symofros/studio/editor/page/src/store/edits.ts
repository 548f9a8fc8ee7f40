/** Changes of the document. The server makes them in the text of the file, and answers with the document. */

import { post, type Refused } from "../api/client";
import type { Document, Edit, Json, Path, Point } from "../api/types";
import { merged } from "../model/merge";
import { afterEdit, recorded, redoneOne, toRedo, toUndo, undoneOne } from "../model/moves";
import { at } from "../model/paths";
import { accept, acceptTheirs, explain, ordered } from "./requests";
import { followRenaming } from "./asked";
import { notify, now, update } from "./store";

const revision = (): number => now().document?.revision ?? 0;

/** Whether the edit's place is still there in a document that somebody else has changed. */
function applies(edit: Edit, document: Document): boolean {
  const place = edit.op === "set" ? edit.path.slice(0, -1) : edit.path;
  return place.length === 0 || at(document.data, place) !== undefined;
}

/** What goes back and forth between edits, and makes none. */
const STEPS = ["api/undo", "api/redo"];

/** What is said of a change that is not made. */
function giveUp(object: string, found: string): void {
  notify({
    object,
    found,
    rule: "a change is made to the newest state of the document that it was meant for",
    remedy: "look at what is shown now, and change it again",
  });
}

/**
 * A change by request, with the revision it is of; made again on a newer state if it still fits there.
 *
 * It is of the document that is open when it is asked for (`of`): where another one has taken its place, be it while
 * earlier requests were answered, it is made to none.
 */
export async function change(
  address: string,
  body: () => object,
  again?: (document: Document) => boolean,
  of = now().document?.path,
): Promise<boolean> {
  const isOther = (): boolean => now().document?.path !== of;
  const ask = (): Promise<Document> => post<Document>(address, { revision: revision(), ...body() });
  const first = async (): Promise<Document | undefined> => {
    if (!isOther()) return ask();
    giveUp(of ?? "the document", "another document was opened before this change was made");
    return undefined;
  };
  const stale = async (refusal: Refused): Promise<Document | undefined> => {
    const theirs = refusal.body.document;
    if (refusal.status !== 409 || theirs === undefined) {
      explain(refusal);
      return undefined;
    }
    acceptTheirs(theirs);
    if (!isOther() && again?.(theirs) === true) {
      return ask().catch((reason: unknown) => {
        explain(reason);
        return undefined;
      });
    }
    giveUp(
      of ?? theirs.path,
      isOther()
        ? `another page has opened ${theirs.path}; your last change was not made`
        : "the document was changed elsewhere, and your last change does not fit any more",
    );
    return undefined;
  };
  const document = await ordered(first, stale);
  if (document === undefined) return false;
  accept(document);
  if (!STEPS.includes(address)) update((state) => ({ moves: afterEdit(state.moves) }));
  return true;
}

/** All edits or none, as one step of undo. Made again on a newer document if their places are still there. */
export async function edit(label: string, edits: Edit[]): Promise<boolean> {
  if (edits.length === 0) return true;
  const moved = renamedPlaces(edits);
  update((state) => ({ places: { ...state.places, ...moved } }));
  const before = now().document;
  const isDone = await change(
    "api/edit",
    () => ({ label, edits }),
    (theirs) => edits.every((each) => applies(each, theirs)),
  );
  if (isDone && before !== null && edits.some(({ op }) => op === "rename")) followRenaming(before);
  return isDone;
}

/** A block that is renamed stays where it is. */
function renamedPlaces(edits: readonly Edit[]): Record<string, Point> {
  const { places } = now();
  return Object.fromEntries(
    edits.flatMap((each) => {
      const place = each.op === "rename" ? places[each.path.join("/")] : undefined;
      return place === undefined || each.op !== "rename"
        ? []
        : [[`${each.path.slice(0, -1).join("/")}/${each.to}`, place]];
    }),
  );
}

export const setValue = (label: string, path: Path, value: Json): Promise<boolean> =>
  edit(label, [{ op: "set", path, value }]);

/** The whole text, made from `base`, of the document at a path; what somebody else changed in it meanwhile is kept. */
export const setText = (text: string, base: string, of?: string): Promise<boolean> =>
  change(
    "api/text",
    () => ({ text: merged(base, text, now().document?.text ?? base) }),
    () => true,
    of,
  );

const step = (): number => now().document?.step ?? 0;

/** Takes back what was done last: a move of blocks, or an edit of the text. */
export async function undo(): Promise<void> {
  // What is on its way was done before.
  await ordered(() => Promise.resolve());
  const move = toUndo(now().moves, step());
  if (move !== undefined) {
    update((state) => ({ moves: undoneOne(state.moves) }));
    await place(move.before);
  } else
    await change(
      "api/undo",
      () => ({}),
      () => true,
    );
}

export async function redo(): Promise<void> {
  await ordered(() => Promise.resolve());
  const move = toRedo(now().moves, step());
  if (move !== undefined) {
    update((state) => ({ moves: redoneOne(state.moves) }));
    await place(move.after);
  } else
    await change(
      "api/redo",
      () => ({}),
      () => true,
    );
}

/** Puts blocks elsewhere; undo puts them back. */
export async function moveBlocks(places: Record<string, Point>): Promise<void> {
  update((state) => ({ moves: recorded(state.moves, state.places, places, step(), Date.now()) }));
  await place(places);
}

/** Puts blocks where they shall be first seen; not part of undo. */
export async function place(places: Record<string, Point>): Promise<void> {
  const path = now().document?.path;
  update((state) => ({ places: { ...state.places, ...places } }));
  // Blocks of another document may have the same names: where they stand is none of ours.
  await ordered(async () => now().document?.path === path && post("api/layout", { path, positions: places }));
}
