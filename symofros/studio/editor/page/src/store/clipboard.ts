/** Copy, cut, paste, and parts of the user's library. */

import { get, post } from "../api/client";
import type { JsonMap, LibraryPart, Part, Point } from "../api/types";
import { extract, insertion } from "../model/clipboard";
import { bodyNames } from "../model/names";
import { isMap } from "../model/paths";
import { carrier, selectedBodies } from "./bodies";
import { change, edit, place } from "./edits";
import { ordered } from "./requests";
import { now, update } from "./store";

const KEY = "symofros_part";
// The system's clipboard can be closed to us; a copy within the page always works.
let copied: Part | null = null;

export function copy(): void {
  const document = now().document;
  const bodies = selectedBodies();
  if (document === null || bodies.length === 0) return;
  copied = extract(document.data, bodies);
  void navigator.clipboard?.writeText(JSON.stringify({ [KEY]: copied }, null, 1)).catch(() => undefined);
}

const SECTIONS = ["bodies", "closures", "parameters", "inputs"] as const;

/** A part out of text from the clipboard, which anybody may have written. */
function parsed(text: string): Part | null {
  let value: unknown;
  try {
    value = JSON.parse(text);
  } catch {
    return null;
  }
  const part = isMap(value as JsonMap) ? (value as JsonMap)[KEY] : undefined;
  return isMap(part) && SECTIONS.every((section) => isMap(part[section])) ? (part as unknown as Part) : null;
}

export async function paste(): Promise<void> {
  const text = (await navigator.clipboard?.readText().catch(() => "")) ?? "";
  const part = parsed(text) ?? copied;
  if (part !== null) await insert(part);
}

async function insert(part: Part): Promise<void> {
  const document = now().document;
  if (document === null) return;
  const { edits, bodies } = insertion(document.data, part);
  if (await edit(`insert ${part.name}`, edits)) choose([...bodies.values()]);
}

function choose(bodies: readonly string[]): void {
  const ids = bodies.map((name) => `bodies/${name}`);
  update({ selected: ids, sight: ids[0] === undefined ? null : { id: ids[0] } });
}

/** Puts a part of the library on the selected body, or on the ground. */
export async function insertPart(name: string, where?: Point): Promise<void> {
  const known = new Set(bodyNames(now().document?.data ?? {}));
  const on = carrier() ?? { body: "world", frame: "" };
  const target = { parent: on.body, ...(on.frame === "" ? {} : { frame: on.frame }) };
  if (!(await change("api/parts/insert", () => ({ name, ...target })))) return;
  const added = bodyNames(now().document?.data ?? {}).filter((body) => !known.has(body));
  if (where !== undefined && added[0] !== undefined) await place({ [`bodies/${added[0]}`]: where });
  choose(added);
}

export async function fetchParts(): Promise<void> {
  const answer = await ordered(() => get<{ parts: LibraryPart[] }>("api/parts"));
  if (answer !== undefined) update({ parts: answer.parts });
}

export async function savePart(name: string, bodies: string[]): Promise<boolean> {
  const answer = await ordered(() => post<{ parts: LibraryPart[] }>("api/parts", { name, bodies }));
  if (answer !== undefined) update({ parts: answer.parts });
  return answer !== undefined;
}
