import { ensureSyntaxTree } from "@codemirror/language";
import { EditorState } from "@codemirror/state";
import { expect, test } from "vitest";

import { yaml } from "../src/text/language";

/** Depth of the syntax tree of a text in the editor. */
function depth(text: string, before = ""): number {
  let state = EditorState.create({ doc: before, extensions: [yaml()] });
  ensureSyntaxTree(state, before.length, 10_000);
  state = state.update({ changes: { from: 0, to: before.length, insert: text } }).state;
  let [now, most] = [0, 0];
  ensureSyntaxTree(state, text.length, 10_000)?.iterate({
    enter: () => void (most = Math.max(most, ++now)),
    leave: () => void now--,
  });
  return most;
}

const MODEL = "symofros: 1\nbodies:\n  a: {joint: {kind: fixed, axes: [[0, 0, 1]]}}\n";

test.each([
  ["lists", "[".repeat(5000) + "]".repeat(5000)],
  ["mappings", "{a: ".repeat(5000) + "1" + "}".repeat(5000)],
  ["lists without an end", "[".repeat(1_000_000)],
  ["items", "- ".repeat(20_000)],
  ["keys", "? ".repeat(5000)],
  ["indented keys", Array.from({ length: 900 }, (_, i) => `${" ".repeat(i)}a:\n`).join("")],
])("deep %s get no syntax tree, nor hold up the page", (_, text) => {
  expect(depth(text)).toBe(1);
  expect(depth(MODEL, text)).toBe(depth(MODEL));
});

test("models have a syntax tree", () => {
  expect(depth(MODEL)).toBeGreaterThan(10);
  expect(depth("[".repeat(199) + "]".repeat(199))).toBeGreaterThan(199);
});
