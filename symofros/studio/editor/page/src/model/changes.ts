/** What a window changed, as edits: new names first, so that all that refers to them follows. */

import type { Edit, Json, Path } from "../api/types";
import { at, difference, replaced, textAt } from "./paths";

/** Paths as text -> the name that the entry there shall have. */
export type Renames = Readonly<Record<string, string>>;

export const keyOf = (path: Path): string => JSON.stringify(path);

/** A path as it is when the entries along it have their new names. */
function renamedPath(path: Path, renames: Renames): Path {
  return path.map((key, i) => renames[keyOf(path.slice(0, i + 1))] ?? key);
}

function renaming(path: Path, renames: Renames): Edit[] {
  const to = renames[keyOf(path)];
  return to === undefined || to === path.at(-1) ? [] : [{ op: "rename", path, to }];
}

/** A joint's name is its coordinate's, so other formulas may use it: it is renamed, not overwritten. */
function jointRenaming(path: Path, before: Json | undefined, after: Json | undefined): Edit[] {
  const place = [...path, "joint"];
  const to = textAt(after, ["joint", "name"]);
  const isKept = at(before, ["joint"]) !== undefined && to !== undefined && to !== textAt(before, ["joint", "name"]);
  return isKept ? [{ op: "rename", path: place, to }] : [];
}

/** A number with the figures that it was typed with, if it is still that number. */
export function asTyped(edit: Edit, typed: ReadonlyMap<string, string>): Edit {
  const text = typed.get(keyOf(edit.path));
  const isIt = text !== undefined && edit.op === "set" && "value" in edit && edit.value === Number(text);
  return isIt ? { op: "set", path: edit.path, text } : edit;
}

/**
 * Edits that turn an entry into what its window says.
 *
 * @param path Of the entry.
 * @param before The entry when the window was opened.
 * @param after The entry now, with the keys that it had.
 * @param renames New names of the entry and of frames in it.
 * @param typed Numbers as they were typed, by path as text.
 */
export function changes(
  path: Path,
  before: Json | undefined,
  after: Json | undefined,
  renames: Renames,
  typed: ReadonlyMap<string, string> = new Map(),
): Edit[] {
  const inner = Object.keys(renames)
    .map((key) => JSON.parse(key) as Path)
    .filter((each) => each.length > path.length);
  const joint = jointRenaming(path, before, after);
  const named =
    joint.length === 0
      ? before
      : replaced(before, "joint", replaced(at(before, ["joint"]), "name", at(after, ["joint", "name"])));
  // From the inside out: each path holds while what it goes through has its old name.
  const names = [...inner.flatMap((each) => renaming(each, renames)), ...joint, ...renaming(path, renames)];
  const rest = difference(named, after, path)
    .map((edit) => asTyped(edit, typed))
    .map((edit) => ({ ...edit, path: renamedPath(edit.path, renames) }));
  return [...names, ...rest];
}
