/** Copy, cut, paste, and parts of the user's library. */

import { get, post } from "../api/client";
import type { JsonMap, Part, Point } from "../api/types";
import { extract, insertion } from "../model/clipboard";
import { isMap } from "../model/paths";
import { edit, place } from "./edits";
import { ordered } from "./requests";
import { now, update } from "./store";

const KEY = "symofros_part";
// The system's clipboard can be closed to us; a copy within the page always works.
let copied: Part | null = null;

export function selectedBodies(): string[] {
  return now()
    .selected.filter((id) => id.startsWith("bodies/") && !id.endsWith("/joint"))
    .map((id) => id.slice("bodies/".length));
}

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
  if (part !== null) await insertPart(part);
}

export async function insertPart(part: Part, where?: Point): Promise<void> {
  const document = now().document;
  if (document === null) return;
  const { edits, bodies } = insertion(document.data, part);
  const ids = [...bodies.values()].map((name) => `bodies/${name}`);
  const first = ids[0];
  if (!(await edit(`insert ${part.name}`, edits))) return;
  if (where !== undefined && first !== undefined) await place({ [first]: where });
  update({ selected: ids, sight: first === undefined ? null : { id: first } });
}

export async function fetchParts(): Promise<void> {
  const answer = await ordered(() => get<{ parts: Part[] }>("api/parts"));
  if (answer !== undefined) update({ parts: answer.parts });
}

export async function savePart(name: string, bodies: string[], overwrite: boolean): Promise<boolean> {
  const done = await ordered(() => post("api/parts", { name, bodies, overwrite }));
  await fetchParts();
  return done !== undefined;
}
