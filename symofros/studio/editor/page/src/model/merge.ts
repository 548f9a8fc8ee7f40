/** Texts that were changed at two places at once. */

export interface Replacement {
  from: number;
  to: number;
  insert: string;
}

/** The smallest replacement that turns one text into the other. */
export function replacement(before: string, after: string): Replacement {
  let from = 0;
  while (from < before.length && from < after.length && before[from] === after[from]) from += 1;
  let tail = 0;
  const most = Math.min(before.length, after.length) - from;
  while (tail < most && before[before.length - 1 - tail] === after[after.length - 1 - tail]) tail += 1;
  return { from, to: before.length - tail, insert: after.slice(from, after.length - tail) };
}

/**
 * Both changes of a text, if they are apart.
 *
 * @returns Where they touch: mine; undo brings theirs back, so nothing is lost.
 */
export function merged(base: string, mine: string, theirs: string): string {
  const a = replacement(base, mine);
  const b = replacement(base, theirs);
  if (a.to < b.from) return theirs.slice(0, a.from) + a.insert + theirs.slice(a.to);
  const shift = b.insert.length - (b.to - b.from);
  if (b.to < a.from) return theirs.slice(0, a.from + shift) + a.insert + theirs.slice(a.to + shift);
  return mine;
}
