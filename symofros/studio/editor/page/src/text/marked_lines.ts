/** Lines of the text that are marked, because they define what is chosen. */

import { StateEffect, StateField } from "@codemirror/state";
import { Decoration, type DecorationSet, EditorView } from "@codemirror/view";

/** First and last line each, counted from 1. */
type Lines = readonly (readonly [number, number])[];

export const markLines = StateEffect.define<Lines>();

const mark = Decoration.line({ class: "cm-chosen" });

export const markedLines = StateField.define<DecorationSet>({
  create: () => Decoration.none,
  update(marks, transaction) {
    const asked = transaction.effects.find((effect) => effect.is(markLines))?.value as Lines | undefined;
    if (asked === undefined) return marks.map(transaction.changes);
    const text = transaction.state.doc;
    const numbers = new Set(
      asked.flatMap(([first, last]) => Array.from({ length: last - first + 1 }, (_, i) => first + i)),
    );
    const shown = [...numbers].filter((number) => number <= text.lines).sort((a, b) => a - b);
    return Decoration.set(shown.map((number) => mark.range(text.line(number).from)));
  },
  provide: (field) => EditorView.decorations.from(field),
});
