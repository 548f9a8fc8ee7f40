/** Elements that were renamed: what was asked of one by its old name while that was on its way is asked of it still. */

import type { Edit, Path } from "../api/types";

interface Renaming {
  path: Path;
  to: string;
}

const made: Renaming[] = [];
const identities = new Map<string, number>();
let last = 0;

const keyOf = (path: Path): string => JSON.stringify(path);

/** A number of an element that stays when it is renamed: its row goes on, with the focus and what is typed in it. */
export function identity(path: Path): number {
  const known = identities.get(keyOf(path));
  if (known !== undefined) return known;
  last += 1;
  identities.set(keyOf(path), last);
  return last;
}

/** Takes the renamings among edits that the server has made, before the document with the new names is shown. */
export function noteRenamings(edits: readonly Edit[]): void {
  for (const each of edits) {
    // A joint's name is a value of it, and no key of its path.
    if (each.op !== "rename" || each.path.at(-2) === "joint") continue;
    const { path, to } = each;
    made.push({ path, to });
    identities.set(keyOf([...path.slice(0, -1), to]), identity(path));
    identities.delete(keyOf(path));
  }
}

/** How many renamings there were so far. */
export const renamings = (): number => made.length;

const isWithin = (path: Path, { path: old }: Renaming): boolean => old.every((key, i) => path[i] === key);

/** The path of the same element after all renamings but the first `since`. */
const followedPath = (path: Path, since: number): Path =>
  made
    .slice(since)
    .reduce(
      (now, each) => (isWithin(now, each) ? [...each.path.slice(0, -1), each.to, ...now.slice(each.path.length)] : now),
      path,
    );

/** Edits of the same elements after all renamings but the first `since`. */
export const followed = (edits: readonly Edit[], since: number): Edit[] =>
  edits.map((each) => ({ ...each, path: followedPath(each.path, since) }));
