import { defaultKeymap, history, historyKeymap, indentWithTab } from "@codemirror/commands";
import { yaml } from "@codemirror/lang-yaml";
import { bracketMatching, indentOnInput } from "@codemirror/language";
import { type Diagnostic, lintGutter, setDiagnostics } from "@codemirror/lint";
import { highlightSelectionMatches, search, searchKeymap } from "@codemirror/search";
import { EditorState, type Text, Transaction } from "@codemirror/state";
import { drawSelection, EditorView, highlightActiveLine, keymap, lineNumbers } from "@codemirror/view";
import { useEffect, useRef } from "react";

import type { Problem } from "../api/types";
import { replacement } from "../model/merge";
import { setText } from "../store/edits";
import { useDocument } from "../store/store";
import { appearance } from "./appearance";

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
  // What the typed text was made from.
  const base = useRef(document.text);

  useEffect(() => {
    // What the person types goes to the server after a pause; what comes from there is marked by `remote`.
    const typed = EditorView.updateListener.of((change) => {
      if (!change.docChanged || change.transactions.every((each) => each.isUserEvent("remote"))) return;
      window.clearTimeout(timer.current);
      timer.current = window.setTimeout(() => {
        timer.current = 0;
        void setText(change.view.state.doc.toString(), base.current);
      }, PAUSE);
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
    ];
    // In a shadow tree the editor's styles are constructed sheets, which a strict content security policy allows.
    const root = (host.current as HTMLDivElement).attachShadow({ mode: "open" });
    const editor = new EditorView({ root, parent: root, state: EditorState.create({ extensions }) });
    view.current = editor;
    return () => {
      if (timer.current !== 0) {
        window.clearTimeout(timer.current);
        void setText(editor.state.doc.toString(), base.current);
      }
      editor.destroy();
    };
  }, []);

  useEffect(() => {
    const editor = view.current;
    // While there is something typed that the server has not seen, its older text must not come over it.
    if (editor === null || timer.current !== 0) return;
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
  }, [document]);

  return <div ref={host} className="text-pane" />;
}
