/** What can be done with a block, a wire, or the canvas: the commands of the menu that the other button opens. */

import type { Point } from "../api/types";
import type { MenuItem } from "../shell/Menu";
import { copy, duplicate, paste } from "../store/clipboard";
import { addBlock, look } from "../store/diagram";
import { remove } from "../store/elements";
import { toggleFolds } from "../store/folding";
import { group } from "../store/grouping";
import { now, show, update } from "../store/store";
import { fileOf, goInto, openProperties, pathOf } from "./open";

/** Adds a comment at a place of the canvas, and asks for its words. */
async function comment(where: Point): Promise<void> {
  const item = now().catalogue?.diagram.palette.find(({ kind }) => kind === "comment");
  if (item === undefined) return;
  const id = await addBlock(item, where);
  if (id !== undefined && now().dialog === null) openProperties(id);
}

/** The commands for an element, or for the canvas where there is none; what is added comes to a place of the canvas. */
export function commandsFor(id: string | null, where: Point): MenuItem[] {
  const { document, selected } = now();
  const diagram = document?.diagram ?? null;
  if (id === null) {
    const all = [...(document?.graph.nodes ?? []), ...(diagram?.nodes ?? [])].map((each) => each.id);
    return [
      { title: "Paste", keys: "Ctrl V", act: () => void paste() },
      ...(diagram === null ? [] : [{ title: "Comment…", act: () => void comment(where) }]),
      { title: "Choose all", keys: "Ctrl A", act: () => update({ selected: all }) },
      { title: "Find…", keys: "Ctrl K", act: () => show({ kind: "search" }) },
    ];
  }
  const chosen = selected.includes(id) ? selected : [id];
  const wire = diagram?.wires.find((each) => each.id === id);
  const isBlock = [...(document?.graph.nodes ?? []), ...(diagram?.nodes ?? [])].some((each) => each.id === id);
  const isCopied = wire === undefined && id !== "world" && !id.endsWith("/joint");
  return [
    { title: "Properties…", keys: "Enter", act: () => openProperties(id) },
    ...(fileOf(pathOf(id) ?? []) === undefined ? [] : [{ title: "Go into it", act: () => goInto(id) }]),
    ...(wire === undefined ? [] : [{ title: "Add a scope", act: () => void look(wire.source, wire.source_port) }]),
    ...(isCopied
      ? [
          { title: "Copy", keys: "Ctrl C", act: copy },
          { title: "Duplicate", keys: "Ctrl D", act: () => void duplicate() },
        ]
      : []),
    ...(isBlock && diagram === null ? [{ title: "Fold or unfold", keys: "F", act: () => toggleFolds(chosen) }] : []),
    ...(isBlock && diagram !== null
      ? [{ title: "Group into a subsystem…", keys: "Ctrl G", act: () => void group(chosen) }]
      : []),
    { title: "Remove", keys: "Delete", act: () => void remove([...chosen]) },
  ];
}
