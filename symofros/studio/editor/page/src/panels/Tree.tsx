import { type KeyboardEvent, useEffect, useMemo, useRef } from "react";

import { openProperties } from "../canvas/open";
import { treeRows } from "../model/tree";
import { reveal } from "../store/folding";
import { useDocument, useStore } from "../store/store";

const INDENT = 14;
/** Deeper rows are not indented further: a chain of fifty bodies would leave the pane. */
const DEEPEST = 10;

/** Where a key leads from a row. */
function target(key: string, at: number, count: number): number | undefined {
  const places: Record<string, number> = { ArrowDown: at + 1, ArrowUp: at - 1, Home: 0, End: count - 1 };
  const to = places[key];
  return to === undefined ? undefined : Math.max(0, Math.min(count - 1, to));
}

/** Bodies, joints, frames and links by name; what is chosen here is chosen everywhere. */
export function Tree() {
  const document = useDocument();
  const selected = useStore((state) => state.selected);
  const rows = useMemo(() => treeRows(document), [document]);
  const list = useRef<HTMLUListElement>(null);
  const current = rows.findIndex(({ id }) => selected.includes(id));
  const row = (at: number): HTMLElement | undefined => list.current?.children[at] as HTMLElement | undefined;

  useEffect(() => {
    row(current)?.scrollIntoView({ block: "nearest" });
  }, [current]);

  const move = (event: KeyboardEvent, at: number): void => {
    const to = target(event.key, at, rows.length);
    const next = to === undefined ? undefined : rows[to];
    if (to === undefined || next === undefined) return;
    event.preventDefault();
    reveal(next.id);
    row(to)?.focus();
  };
  return (
    <ul ref={list} className="tree" role="tree" aria-label="Elements" aria-multiselectable>
      {rows.map(({ id, title, what, depth }, at) => (
        <li
          key={id}
          role="treeitem"
          data-id={id}
          aria-level={depth + 1}
          aria-selected={selected.includes(id)}
          tabIndex={at === Math.max(0, current) ? 0 : -1}
          style={{ paddingLeft: 8 + INDENT * Math.min(depth, DEEPEST) }}
          onClick={() => reveal(id)}
          onDoubleClick={() => openProperties(id)}
          onKeyDown={(event) => move(event, at)}
        >
          <span>{title}</span> <span className="quiet">{what}</span>
        </li>
      ))}
    </ul>
  );
}
