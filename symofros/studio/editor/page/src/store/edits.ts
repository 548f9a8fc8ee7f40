/** Changes of the document. The server makes them in the text of the file, and answers with the document. */

import { post, type Refused } from "../api/client";
import type { Document, Edit, Json, Path, Point } from "../api/types";
import { merged } from "../model/merge";
import { at } from "../model/paths";
import { accept, explain, ordered } from "./requests";
import { notify, now, update } from "./store";

const revision = (): number => now().document?.revision ?? 0;

/** Whether the edit's place is still there in a document that somebody else has changed. */
function applies(edit: Edit, document: Document): boolean {
  const place = edit.op === "set" ? edit.path.slice(0, -1) : edit.path;
  return place.length === 0 || at(document.data, place) !== undefined;
}

/** A change by request: with the revision it is of; made again on a newer document if it still fits there. */
export async function change(
  address: string,
  body: () => object,
  again?: (document: Document) => boolean,
): Promise<boolean> {
  const ask = (): Promise<Document> => post<Document>(address, { revision: revision(), ...body() });
  const stale = async (refusal: Refused): Promise<Document | undefined> => {
    const theirs = refusal.body.document;
    if (refusal.status !== 409 || theirs === undefined) {
      explain(refusal);
      return undefined;
    }
    accept(theirs);
    if (again?.(theirs) === true) {
      return ask().catch((reason: unknown) => {
        explain(reason);
        return undefined;
      });
    }
    notify({
      object: theirs.name,
      found: "the document was changed elsewhere, and your last change does not fit any more",
      rule: "a change is made to the newest document",
      remedy: "look at what is shown now, and change it again",
    });
    return undefined;
  };
  const document = await ordered(ask, stale);
  if (document !== undefined) accept(document);
  return document !== undefined;
}

/** All edits or none, as one step of undo. Made again on a newer document if their places are still there. */
export async function edit(label: string, edits: Edit[]): Promise<boolean> {
  if (edits.length === 0) return true;
  const moved = renamedPlaces(edits);
  update((state) => ({ places: { ...state.places, ...moved } }));
  return change(
    "api/edit",
    () => ({ label, edits }),
    (theirs) => edits.every((each) => applies(each, theirs)),
  );
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

/** The whole text, made from `base`; what somebody else changed in it meanwhile is kept. */
export const setText = (text: string, base: string): Promise<boolean> =>
  change(
    "api/text",
    () => ({ text: merged(base, text, now().document?.text ?? base) }),
    () => true,
  );
export const undo = (): Promise<boolean> =>
  change(
    "api/undo",
    () => ({}),
    () => true,
  );
export const redo = (): Promise<boolean> =>
  change(
    "api/redo",
    () => ({}),
    () => true,
  );

/** Puts blocks; not part of undo. */
export async function place(places: Record<string, Point>): Promise<void> {
  update((state) => ({ places: { ...state.places, ...places } }));
  await ordered(() => post("api/layout", { positions: places }));
}
