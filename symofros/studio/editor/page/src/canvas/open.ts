/** What Enter and a double click do to a block or a link. */

import type { Path } from "../api/types";
import { blockOf } from "../model/elements";
import { mapAt, textAt } from "../model/paths";
import { enter } from "../store/files";
import { now, show } from "../store/store";

/** The entry of the document that an element is about. */
export function pathOf(id: string): Path | undefined {
  const document = now().document;
  const all = [
    ...(document?.graph.nodes ?? []),
    ...(document?.graph.edges ?? []),
    ...(document?.diagram?.nodes ?? []),
    ...(document?.diagram?.wires ?? []),
  ];
  const block = document === null ? id : blockOf(document.graph, id);
  return all.find((each) => each.id === id)?.path ?? all.find((each) => each.id === block)?.path;
}

/** Opens the property window of a block or a link. */
export function openProperties(id: string): void {
  const path = pathOf(id);
  if (path === undefined) return;
  // A wire into a block is an entry of that block; one that `wires` states belongs to none.
  if (path[0] === "wires") show({ kind: "properties", path: ["wires"] });
  else show({ kind: "properties", path: path.slice(0, 2) });
}

/** The file that a model or a part of a diagram is read from; undefined for what has none. */
export function fileOf(path: Path): string | undefined {
  const isFile = path[0] === "models" || path[0] === "parts";
  return isFile ? textAt(mapAt(now().document?.data, path), ["file"]) : undefined;
}

/** Goes into what has a canvas of its own, and opens the window of what has none. */
export function goInto(id: string): void {
  const file = fileOf(pathOf(id) ?? []);
  if (file === undefined) openProperties(id);
  else void enter(file);
}
