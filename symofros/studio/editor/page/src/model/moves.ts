/** Moves of blocks, which are undone in turn with the edits of the text, though the text says nothing of places. */

import type { Places } from "./places";

export interface Move {
  label: string;
  /** How many edits of the text were in force when it was made. */
  step: number;
  /** When it was made [ms]. */
  at: number;
  before: Places;
  after: Places;
}

export interface Moves {
  /** The newest last. */
  done: readonly Move[];
  /** The one to be done again first is the last. */
  undone: readonly Move[];
}

export const NO_MOVES: Moves = { done: [], undone: [] };

/** Moves by keys that follow each other so fast are one [ms]. */
const ONE = 700;
const MOST = 500;

/** The moves with a new one; none where nothing has moved. */
export function recorded(moves: Moves, places: Places, after: Places, step: number, at: number): Moves {
  const moved = Object.entries(after).filter(([id, [x, y]]) => {
    const old = places[id];
    return old !== undefined && (old[0] !== x || old[1] !== y);
  });
  const names = moved.map(([id]) => id.split("/").at(-1) ?? id);
  if (moved.length === 0) return moves;
  const move: Move = {
    label: moved.length === 1 ? `move ${names[0] ?? ""}` : `move ${moved.length} blocks`,
    step,
    at,
    before: Object.fromEntries(moved.map(([id]) => [id, places[id] ?? [0, 0]])),
    after: Object.fromEntries(moved),
  };
  const last = moves.done.at(-1);
  const isSame =
    last?.step === step &&
    at - last.at < ONE &&
    Object.keys(last.after).join("\n") === Object.keys(move.after).join("\n");
  const kept = isSame ? moves.done.slice(0, -1) : moves.done;
  return { done: [...kept, isSame ? { ...move, before: last.before } : move].slice(-MOST), undone: [] };
}

/** The move that undo takes back now; undefined where an edit of the text is newer. */
export const toUndo = ({ done }: Moves, step: number): Move | undefined =>
  done.at(-1)?.step === step ? done.at(-1) : undefined;

/** The move that redo makes again now; undefined where an edit of the text comes before. */
export const toRedo = ({ undone }: Moves, step: number): Move | undefined =>
  undone.at(-1)?.step === step ? undone.at(-1) : undefined;

/** The moves after a new edit: nothing can be done again. */
export const afterEdit = (moves: Moves): Moves => (moves.undone.length === 0 ? moves : { ...moves, undone: [] });

export const undoneOne = ({ done, undone }: Moves): Moves => ({
  done: done.slice(0, -1),
  undone: [...undone, ...done.slice(-1)],
});

export const redoneOne = ({ done, undone }: Moves): Moves => ({
  done: [...done, ...undone.slice(-1)],
  undone: undone.slice(0, -1),
});
