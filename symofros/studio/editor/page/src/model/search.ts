/** Everything in a document that has a name. */

import type { Document } from "../api/types";
import { frameNames, jointName } from "./names";
import { isMap, mapAt } from "./paths";

export interface Hit {
  /** What it is, such as `frame of upper`. */
  what: string;
  name: string;
  /** The block or link to go to; "" if it is none. */
  id: string;
}

export function everything(document: Document): Hit[] {
  const { data } = document;
  if (document.diagram !== null)
    return document.diagram.nodes.map(({ id, title, kind }) => ({ what: kind.replaceAll("_", " "), name: title, id }));
  const hits: Hit[] = [];
  for (const [body, value] of Object.entries(mapAt(data, ["bodies"]))) {
    const node = document.graph.nodes.find((each) => each.path[0] === "bodies" && each.path[1] === body);
    const id = node?.id ?? "";
    hits.push({ what: node?.kind.replace("_", " ") ?? "body", name: body, id });
    if (isMap(value) && isMap(value["joint"])) hits.push({ what: `joint of ${body}`, name: jointName(data, body), id });
    for (const frame of frameNames(data, body)) hits.push({ what: `frame of ${body}`, name: frame, id });
  }
  for (const section of ["closures", "connections", "contacts", "nonholonomic"] as const) {
    for (const name of Object.keys(mapAt(data, [section])))
      hits.push({ what: section.replace(/s$/, ""), name, id: `${section}/${name}` });
  }
  for (const section of ["parameters", "inputs"] as const) {
    for (const name of Object.keys(mapAt(data, [section])))
      hits.push({ what: section.replace(/s$/, ""), name, id: "" });
  }
  return hits;
}

/** Hits whose name or kind has every word; names that begin with the text come first. */
export function search(hits: readonly Hit[], text: string): Hit[] {
  const words = text.toLowerCase().split(/\s+/).filter(Boolean);
  const found = hits.filter(({ name, what }) => words.every((word) => `${name} ${what}`.toLowerCase().includes(word)));
  const rank = ({ name }: Hit): number => (name.toLowerCase().startsWith(text.toLowerCase()) ? 0 : 1);
  return found.sort((a, b) => rank(a) - rank(b)).slice(0, 50);
}
