import { expect, test } from "vitest";

import { afterEdit, NO_MOVES, recorded, redoneOne, toRedo, toUndo, undoneOne } from "../src/model/moves";
import type { Places } from "../src/model/places";

const start: Places = { "bodies/a": [0, 0], "bodies/b": [10, 0] };

test("a move is undone while no edit is newer, and done again before later edits are", () => {
  const moves = recorded(NO_MOVES, start, { ...start, "bodies/a": [4, 8] }, 1, 0);
  expect(toUndo(moves, 1)).toMatchObject({ label: "move a", before: { "bodies/a": [0, 0] } });
  expect(toUndo(moves, 2)).toBeUndefined(); // After an edit.
  expect(toUndo(moves, 1)?.after).toEqual({ "bodies/a": [4, 8] });
  const back = undoneOne(moves);
  expect([toUndo(back, 1), toRedo(back, 0)]).toEqual([undefined, undefined]);
  expect(toRedo(back, 1)?.after).toEqual({ "bodies/a": [4, 8] });
  expect(redoneOne(back)).toEqual(moves);
});

test("what stays is no move; several blocks are one", () => {
  expect(recorded(NO_MOVES, start, start, 0, 0)).toBe(NO_MOVES);
  const both = recorded(NO_MOVES, start, { "bodies/a": [1, 0], "bodies/b": [11, 0] }, 0, 0);
  expect(toUndo(both, 0)?.label).toBe("move 2 blocks");
});

test("strokes of a key that follow each other are one move", () => {
  const first = recorded(NO_MOVES, start, { "bodies/a": [4, 0] }, 0, 1000);
  const second = recorded(first, { "bodies/a": [4, 0] }, { "bodies/a": [8, 0] }, 0, 1300);
  expect(second.done).toHaveLength(1);
  expect(toUndo(second, 0)).toMatchObject({ before: { "bodies/a": [0, 0] }, after: { "bodies/a": [8, 0] } });
  expect(recorded(second, { "bodies/a": [8, 0] }, { "bodies/a": [9, 0] }, 0, 9000).done).toHaveLength(2);
});

test("a new edit leaves nothing to be done again", () => {
  const undone = undoneOne(recorded(NO_MOVES, start, { "bodies/a": [4, 0] }, 3, 0));
  expect(afterEdit(undone)).toEqual(NO_MOVES);
});
