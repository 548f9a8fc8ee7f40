/** Sizes of a diagram's blocks and places of their ports. */

import type { Point, SignalNode } from "../api/types";

export const BLOCK_WIDTH = 136;
export const HEAD = 26;
const ROW = 17;
const PAD = 6;
const FOOT = 17;

/** Widest comment, and how wide and high its letters are, about. */
const WIDEST = 260;
const WORDS = { text: { letter: 6.4, line: 16 }, heading: { letter: 10, line: 24 } };

/** Width and height of the words of a comment, lines broken where they must be. */
function commentSize({ note, heading = false }: SignalNode): Point {
  const { letter, line } = heading ? WORDS.heading : WORDS.text;
  const lines = note.split("\n");
  const longest = Math.max(8, ...lines.map(({ length }) => length)) * letter;
  const width = heading ? longest : Math.min(WIDEST, longest);
  const rows = lines.map(({ length }) => Math.max(1, Math.ceil((length * letter) / width)));
  return [Math.ceil(width) + 2 * PAD, line * rows.reduce((sum, each) => sum + each, 0) + 2 * PAD];
}

export function blockSize(node: SignalNode): Point {
  if (node.kind === "comment") return commentSize(node);
  const rows = Math.max(node.inputs.length, node.outputs.length);
  const foot = node.note === "" ? 0 : FOOT;
  return [BLOCK_WIDTH, HEAD + (rows === 0 ? 2 : 2 * PAD + ROW * rows) + foot];
}

/** Height of a port's middle below its block's top. */
export const rowHeight = (row: number): number => HEAD + PAD + ROW * (row + 0.5);

/** Where an output leaves its block. */
export function outlet(node: SignalNode, port: string): Point {
  const row = node.outputs.findIndex(({ name }) => name === port);
  return [BLOCK_WIDTH, rowHeight(Math.max(0, row))];
}

/** Where an input enters its block. */
export function inlet(node: SignalNode, port: string): Point {
  const row = node.inputs.findIndex(({ name }) => name === port);
  return [0, rowHeight(Math.max(0, row))];
}
