/** Copy, cut, paste, and parts of the user's library. */

import { get, post } from "../api/client";
import type { JsonMap, LibraryPart, Part, Point } from "../api/types";
import { extract, insertion } from "../model/clipboard";
import { type BlockPart, blockInsertion, extractBlocks } from "../model/diagram_clipboard";
import { bodyNames } from "../model/names";
import { isMap } from "../model/paths";
import type { Places } from "../model/places";
import { carrier } from "./bodies";
import { change, editInTurn, place } from "./edits";
import { remove } from "./elements";
import { ordered } from "./requests";
import { notify, now, update } from "./store";

// What a copy in the clipboard is called: bodies of a mechanism, blocks of a diagram.
const KEYS = { bodies: "symofros_part", blocks: "symofros_blocks" } as const;
const SECTIONS = {
  bodies: ["bodies", "links", "switches", "parameters", "inputs"],
  blocks: ["models", "blocks", "parts", "wires", "places"],
} as const;
const SHIFT = 40;

type Copied = { kind: "bodies"; part: Part } | { kind: "blocks"; part: BlockPart };

// The system's clipboard can be closed to us; a copy within the page always works.
let copied: Copied | null = null;
// How often it has been put in: copies do not lie upon each other.
let pasted = 0;

/** A copy of what is chosen; null where that can't be copied. */
function extracted(): Copied | null {
  const { document, selected, places } = now();
  if (document === null || selected.length === 0) return null;
  if (document.diagram !== null) return { kind: "blocks", part: extractBlocks(document.data, selected, places) };
  const part = extract(document.data, selected);
  return part.name === "" ? null : { kind: "bodies", part };
}

export function copy(): void {
  const given = extracted();
  if (given === null) return;
  [copied, pasted] = [given, 0];
  const text = JSON.stringify({ [KEYS[given.kind]]: given.part }, null, 1);
  void navigator.clipboard?.writeText(text).catch(() => undefined);
}

export function cut(): void {
  copy();
  void remove(now().selected);
}

/** Puts a copy of what is chosen beside it; what was copied before stays in the clipboard. */
export async function duplicate(): Promise<void> {
  const given = extracted();
  if (given?.kind === "blocks") await insertBlocks(given.part, SHIFT);
  else if (given !== null) await insert(given.part);
}

/** A copy out of text from the clipboard, which anybody may have written. */
function parsed(text: string): Copied | null {
  let value: unknown;
  try {
    value = JSON.parse(text);
  } catch {
    return null;
  }
  for (const kind of ["bodies", "blocks"] as const) {
    const part = isMap(value as JsonMap) ? (value as JsonMap)[KEYS[kind]] : undefined;
    if (!isMap(part) || !SECTIONS[kind].every((section) => isMap(part[section]))) continue;
    if (kind === "bodies" || Array.isArray(part["chosen"])) return { kind, part } as unknown as Copied;
  }
  return null;
}

export async function paste(): Promise<void> {
  const text = (await navigator.clipboard?.readText().catch(() => "")) ?? "";
  const document = now().document;
  const given = parsed(text) ?? copied;
  if (given === null || document === null) return;
  if ((given.kind === "blocks") !== (document.diagram !== null)) {
    const [theirs, ours] = given.kind === "blocks" ? ["blocks", "a mechanism"] : ["bodies", "a diagram"];
    notify({
      object: "paste",
      found: `${theirs} for ${ours}`,
      rule: "bodies go into mechanisms, blocks into diagrams",
      remedy: "open a document of the other kind",
    });
  } else if (given.kind === "blocks") await insertBlocks(given.part, SHIFT * (pasted += 1));
  else await insert(given.part);
}

async function insert(part: Part): Promise<void> {
  let added: string[] = [];
  const isDone = await editInTurn(() => {
    const { edits, ids } = insertion(now().document?.data ?? {}, part);
    added = ids;
    return { label: `insert ${part.name}`, edits };
  });
  if (isDone) choose(added);
}

async function insertBlocks(part: BlockPart, shift: number): Promise<void> {
  let [ids, places]: [string[], Places] = [[], {}];
  const isDone = await editInTurn(() => {
    const { edits, places: found } = blockInsertion(now().document?.data ?? {}, part, shift);
    ids = edits.filter(({ path }) => path[0] !== "wires").map(({ path }) => path.join("/"));
    places = found;
    update((state) => ({ places: { ...state.places, ...found } }));
    return { label: `paste ${ids.length === 1 ? ids[0]?.split("/")[1] : `${ids.length} blocks`}`, edits };
  });
  if (!isDone) return;
  if (Object.keys(places).length > 0) await place(places);
  choose(ids);
}

function choose(ids: string[]): void {
  update({ selected: ids, sight: ids[0] === undefined ? null : { id: ids[0] } });
}

/** Puts a part of the library on the selected body, or on the ground. */
export async function insertPart(name: string, where?: Point): Promise<void> {
  let known = new Set<string>();
  const on = carrier() ?? { body: "world", frame: "" };
  const target = { parent: on.body, ...(on.frame === "" ? {} : { frame: on.frame }) };
  const ask = (): object => {
    known = new Set(bodyNames(now().document?.data ?? {}));
    return { name, ...target };
  };
  if (!(await change("api/parts/insert", ask))) return;
  const added = bodyNames(now().document?.data ?? {}).filter((body) => !known.has(body));
  if (where !== undefined && added[0] !== undefined) await place({ [`bodies/${added[0]}`]: where });
  choose(added.map((body) => `bodies/${body}`));
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
