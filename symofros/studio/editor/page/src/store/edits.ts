/** Changes of the document. The server makes them in the text of the file, and answers with the document. */

import { post, type Refused } from "../api/client";
import type { Document, Edit, Json, JsonMap, Path, Point } from "../api/types";
import { merged } from "../model/merge";
import { afterEdit, recorded, redoneOne, toRedo, toUndo, undoneOne } from "../model/moves";
import { fresh } from "../model/names";
import { at } from "../model/paths";
import type { Places } from "../model/places";
import { accept, acceptTheirs, explain, ordered } from "./requests";
import { followRenaming } from "./asked";
import { followed, noteRenamings, renamings } from "./renamed";
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

interface Terms {
  /** Whether it still fits a newer state of the document, on which it is made again. */
  again?: (document: Document) => boolean;
  /** Path of the document that it is of. */
  of?: string | undefined;
  /** What is done in its place when its turn comes; whether something was. */
  instead?: () => Promise<boolean>;
  /** Called when the server has made it, before the new document is shown. */
  made?: () => void;
}

/**
 * A change by request, with the revision it is of: `body` is asked when its turn comes, for the document as it is then.
 *
 * It is of the document that is open when it is asked for: where another one has taken its place, be it while earlier
 * requests were answered, it is made to none.
 */
export async function change(
  address: string,
  body: () => object,
  { again, of = now().document?.path, instead, made }: Terms = {},
): Promise<boolean> {
  const isOther = (): boolean => now().document?.path !== of;
  const ask = (): Promise<Document> => post<Document>(address, { revision: revision(), ...body() });
  const first = async (): Promise<Document | undefined> => {
    if (!isOther()) return (await instead?.()) === true ? undefined : ask();
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
  made?.();
  accept(document);
  if (!STEPS.includes(address)) update((state) => ({ moves: afterEdit(state.moves) }));
  return true;
}

/** All edits or none, as one step of undo. Made again on a newer document if their places are still there. */
export async function edit(label: string, edits: readonly Edit[]): Promise<boolean> {
  if (edits.length === 0) return true;
  const moved = renamedPlaces(edits);
  update((state) => ({ places: { ...state.places, ...moved } }));
  let before: Document | null = null;
  const since = renamings();
  const present = (): Edit[] => followed(edits, since);
  const isDone = await change("api/edit", () => ({ label, edits: present() }), {
    again: (theirs) => present().every((each) => applies(each, theirs)),
    made: () => {
      before = now().document;
      noteRenamings(present());
    },
  });
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

/** As `edit`, of what is thought of when its turn comes: the names that earlier edits have taken are known then. */
export const editInTurn = (step: () => { label: string; edits: Edit[] }): Promise<boolean> =>
  change("api/edit", step, { again: () => true });

/** Adds an entry to a section, under a name that none of `taken` is when its turn comes; undefined if it was refused. */
export async function addEntry(
  section: string,
  stem: string,
  taken: (data: JsonMap) => string[],
  value: (name: string, data: JsonMap) => Json,
): Promise<string | undefined> {
  let name = "";
  const isDone = await editInTurn(() => {
    const data = now().document?.data ?? {};
    name = fresh(stem, taken(data));
    return { label: `add ${name}`, edits: [{ op: "set", path: [section, name], value: value(name, data) }] };
  });
  return isDone ? name : undefined;
}

export const setValue = (label: string, path: Path, value: Json): Promise<boolean> =>
  edit(label, [{ op: "set", path, value }]);

/** The whole text, made from `base`, of the document at a path; what somebody else changed in it meanwhile is kept. */
export const setText = (text: string, base: string, of?: string): Promise<boolean> =>
  change("api/text", () => ({ text: merged(base, text, now().document?.text ?? base) }), { again: () => true, of });

const step = (): number => now().document?.step ?? 0;

/** Goes back or forth by one: a move of blocks where one is due (`next`), else an edit of the text. */
async function go(
  address: string,
  next: typeof toUndo,
  gone: typeof undoneOne,
  stand: "before" | "after",
): Promise<void> {
  // Decided when its turn comes: what is on its way was done before, and what is done after comes after.
  const moved = async (): Promise<boolean> => {
    const move = next(now().moves, step());
    if (move === undefined) return false;
    update((state) => ({ moves: gone(state.moves), places: { ...state.places, ...move[stand] } }));
    await keepPlaces(move[stand]);
    return true;
  };
  await change(address, () => ({}), { again: () => true, instead: moved });
}

/** Takes back what was done last: a move of blocks, or an edit of the text. */
export const undo = (): Promise<void> => go("api/undo", toUndo, undoneOne, "before");

export const redo = (): Promise<void> => go("api/redo", toRedo, redoneOne, "after");

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
  await ordered(async () => now().document?.path === path && keepPlaces(places));
}

/** Has the server keep where blocks of the open document stand. */
const keepPlaces = (positions: Places): Promise<unknown> =>
  post("api/layout", { path: now().document?.path, positions });
