/** Keys that work wherever no field and no window has the focus. */

import { openProperties } from "../canvas/open";
import { remove } from "../store/elements";
import { copy, cut, duplicate, paste } from "../store/clipboard";
import { redo, undo } from "../store/edits";
import { browse, leave, save } from "../store/files";
import { toggleFolds } from "../store/folding";
import { group } from "../store/grouping";
import { now, show, update } from "../store/store";

const isTyping = (target: EventTarget | null): boolean =>
  target instanceof HTMLElement && target.closest("input, select, textarea, dialog, .text-pane") !== null;

/** The block or link that has the focus, else the only chosen one. */
function focused(target: EventTarget | null): string | undefined {
  const element = target instanceof Element ? target.closest("[data-id]") : null;
  const id = element?.getAttribute("data-id");
  return id ?? (now().selected.length === 1 && target === window.document.body ? now().selected[0] : undefined);
}

const WITH_CONTROL: Record<string, () => void> = {
  z: () => void undo(),
  y: () => void redo(),
  Z: () => void redo(),
  s: () => void save(),
  S: () => show({ kind: "save as" }),
  o: () => void browse(),
  k: () => show({ kind: "search" }),
  c: copy,
  x: cut,
  v: () => void paste(),
  d: () => void duplicate(),
  g: () => void group(now().selected),
  a: () => {
    const { graph, diagram } = now().document ?? {};
    update({ selected: [...(graph?.nodes ?? []), ...(diagram?.nodes ?? [])].map(({ id }) => id) });
  },
};

const ALONE: Record<string, () => void> = {
  "/": () => show({ kind: "search" }),
  "?": () => show({ kind: "keys" }),
  f: () => toggleFolds(now().selected),
  Delete: () => void remove(now().selected),
  Backspace: () => void remove(now().selected),
};

// These are the page's own even while one types in a field; the others are the field's.
const EVERYWHERE = ["s", "S", "k", "o"];
// These too, in a field of which all that was typed is in the document.
const SETTLED = ["z", "y", "Z"];

function isFields(event: KeyboardEvent): boolean {
  if (!isTyping(event.target)) return false;
  if (!event.ctrlKey && !event.metaKey) return true;
  const isSettled = event.target instanceof HTMLElement && event.target.dataset["settled"] === "true";
  return !EVERYWHERE.includes(event.key) && !(isSettled && SETTLED.includes(event.key));
}

// What these mean elsewhere, such as copying text out of a table, is the browser's.
const DIAGRAMS = ["c", "x", "v", "d", "a", "Delete", "Backspace"];

function isElsewhere(event: KeyboardEvent): boolean {
  const isDiagram =
    event.target === window.document.body ||
    (event.target instanceof Element && event.target.closest(".canvas") !== null);
  return DIAGRAMS.includes(event.key) && (!isDiagram || window.getSelection()?.isCollapsed === false);
}

export function onKey(event: KeyboardEvent): void {
  if (now().dialog !== null || now().document === null) return;
  const control = event.ctrlKey || event.metaKey;
  if (isFields(event) || isElsewhere(event)) return;
  if (event.key === "Enter" && !control) {
    const id = focused(event.target);
    if (id !== undefined) {
      event.preventDefault();
      openProperties(id);
    }
    return;
  }
  if (event.altKey && event.key === "ArrowLeft" && (now().document?.trail.length ?? 0) > 0) {
    event.preventDefault();
    void leave();
    return;
  }
  const act = control ? WITH_CONTROL[event.key] : ALONE[event.key];
  if (act === undefined) return;
  event.preventDefault();
  act();
}
