import { defaultKeymap, history, historyKeymap, indentWithTab } from "@codemirror/commands";
import { bracketMatching, indentOnInput } from "@codemirror/language";
import { type Diagnostic, lintGutter, setDiagnostics } from "@codemirror/lint";
import { highlightSelectionMatches, search, searchKeymap } from "@codemirror/search";
import { EditorState, type Text, Transaction } from "@codemirror/state";
import { drawSelection, EditorView, highlightActiveLine, keymap, lineNumbers } from "@codemirror/view";
import { useEffect, useRef, useState } from "react";

import type { Problem } from "../api/types";
import { elementAt, linesOf } from "../model/elements";
import { replacement } from "../model/merge";
import { setText } from "../store/edits";
import { reveal } from "../store/folding";
import { now, update, useDocument, useStore } from "../store/store";
import { sentBefore } from "../store/unsent";
import { appearance } from "./appearance";
import { yaml } from "./language";
import { markedLines, markLines } from "./marked_lines";

const PAUSE = 400;

function diagnostics(problems: readonly Problem[], text: Text): Diagnostic[] {
  return problems
    .filter((problem) => problem.line > 0 && problem.line <= text.lines)
    .map((problem) => {
      const line = text.line(problem.line);
      return {
        from: line.from,
        to: line.to,
        severity: "error",
        message: `${problem.object}: ${problem.found}. ${problem.remedy}`,
      };
    });
}

/** The file's text, beside the diagram and in step with it. */
export default function TextPane() {
  const document = useDocument();
  const host = useRef<HTMLDivElement>(null);
  const view = useRef<EditorView | null>(null);
  const timer = useRef(0);
  // What the typed text was made from, and the document that it is of.
  const [left] = useState(() => now().leftText);
  const base = useRef(left?.base ?? document.text);
  const path = useRef(document.path);
  // Whether something is typed that the server has not taken.
  const isAhead = useRef(left !== null);
  const link = useStore((state) => state.link);
  const selected = useStore((state) => state.selected);
  const resend = useRef<() => void>(() => undefined);
  const follow = useRef<() => void>(() => undefined);
  // What the caret has chosen last.
  const byCaret = useRef("");
  // What the text has been scrolled to.
  const seen = useRef<readonly string[]>([]);

  useEffect(() => {
    const send = async (): Promise<void> => {
      window.clearTimeout(timer.current);
      timer.current = 0;
      const text = view.current?.state.doc.toString();
      if (!isAhead.current || text === undefined) return;
      const isTaken = await setText(text, base.current, path.current);
      // Without an answer it stays to be sent; what was refused is said, and what is in the document shown.
      if (isTaken) base.current = text;
      else if (now().link !== "ok" && view.current === null) update({ leftText: { text, base: base.current } });
      if (timer.current === 0 && (isTaken || now().link === "ok")) isAhead.current = false;
      follow.current();
    };
    resend.current = () => void send();
    const forgetSend = sentBefore(send);
    // What the person types goes to the server after a pause; what comes from there is marked by `remote`.
    const typed = EditorView.updateListener.of((change) => {
      if (!change.docChanged || change.transactions.every((each) => each.isUserEvent("remote"))) return;
      window.clearTimeout(timer.current);
      isAhead.current = true;
      timer.current = window.setTimeout(() => void send(), PAUSE);
    });
    // The caret chooses what its line defines, as far as the server has seen the text.
    const placed = EditorView.updateListener.of((change) => {
      const { document: known, selected } = now();
      if (!change.transactions.some((each) => each.isUserEvent("select")) || isAhead.current || known === null) return;
      const { head } = change.state.selection.main;
      const id = elementAt(known.lines, change.state.doc.lineAt(head).number);
      if (id === undefined || (selected.length === 1 && selected[0] === id)) return;
      byCaret.current = id;
      reveal(id);
    });
    const extensions = [
      lineNumbers(),
      history(),
      drawSelection(),
      indentOnInput(),
      bracketMatching(),
      highlightActiveLine(),
      highlightSelectionMatches(),
      search({ top: true }),
      lintGutter(),
      yaml(),
      appearance,
      keymap.of([...defaultKeymap, ...searchKeymap, ...historyKeymap, indentWithTab]),
      EditorView.contentAttributes.of({ "aria-label": "Text of the file", tabindex: "0" }),
      typed,
      placed,
      markedLines,
    ];
    // In a shadow tree the editor's styles are constructed sheets, which a strict content security policy allows.
    const root = (host.current as HTMLDivElement).attachShadow({ mode: "open" });
    const editor = new EditorView({
      root,
      parent: root,
      state: EditorState.create({ doc: left?.text ?? "", extensions }),
    });
    update({ leftText: null });
    view.current = editor;
    return () => {
      forgetSend();
      void send();
      view.current = null;
      editor.destroy();
    };
  }, []);

  useEffect(() => {
    if (link === "ok" && isAhead.current && timer.current === 0) resend.current();
  }, [link]);

  follow.current = (): void => {
    const editor = view.current;
    // While there is something typed that the server has not seen, its older text must not come over it.
    if (editor === null || isAhead.current) return;
    const { document } = now();
    if (document === null || document.path !== path.current) return;
    base.current = document.text;
    const shown = editor.state.doc.toString();
    if (shown !== document.text) {
      editor.dispatch({
        changes: replacement(shown, document.text),
        userEvent: "remote",
        annotations: Transaction.addToHistory.of(false),
      });
    }
    editor.dispatch(setDiagnostics(editor.state, diagnostics(document.problems, editor.state.doc)));
  };
  useEffect(() => follow.current(), [document]);

  useEffect(() => {
    const editor = view.current;
    if (editor === null) return;
    const lines = selected.flatMap((id) => [linesOf(document.lines, id) ?? []].filter((each) => each.length === 2));
    editor.dispatch({ effects: markLines.of(lines) });
    const first = lines[0]?.[0];
    // Where the caret has chosen it, the lines are in sight.
    const isSeen = seen.current === selected || byCaret.current === selected[0];
    if (first !== undefined && first <= editor.state.doc.lines && !isSeen)
      editor.dispatch({ effects: EditorView.scrollIntoView(editor.state.doc.line(first).from, { y: "center" }) });
    byCaret.current = "";
    seen.current = selected;
  }, [selected, document]);

  return <div ref={host} className="text-pane" />;
}
