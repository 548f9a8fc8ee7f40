/** Copy, cut, paste, and parts of the user's library. */

import { get, post } from "../api/client";
import type { JsonMap, LibraryPart, Part, Point } from "../api/types";
import { extract, insertion } from "../model/clipboard";
import { type BlockPart, blockInsertion, extractBlocks } from "../model/diagram_clipboard";
import { bodyNames } from "../model/names";
import { isMap } from "../model/paths";
import type { Places } from "../model/places";
import { carrier, selectedBodies } from "./bodies";
import { change, editInTurn, place } from "./edits";
import { ordered } from "./requests";
import { notify, now, update } from "./store";

// What a copy in the clipboard is called: bodies of a mechanism, blocks of a diagram.
const KEYS = { bodies: "symofros_part", blocks: "symofros_blocks" } as const;
const SECTIONS = {
  bodies: ["bodies", "closures", "parameters", "inputs"],
  blocks: ["models", "blocks", "parts", "wires", "places"],
} as const;
const SHIFT = 40;

type Copied = { kind: "bodies"; part: Part } | { kind: "blocks"; part: BlockPart };

// The system's clipboard can be closed to us; a copy within the page always works.
let copied: Copied | null = null;
// How often it has been put in: copies do not lie upon each other.
let pasted = 0;

export function copy(): void {
  const { document, selected, places } = now();
  if (document === null || selected.length === 0) return;
  if (document.diagram !== null) copied = { kind: "blocks", part: extractBlocks(document.data, selected, places) };
  else if (selectedBodies().length > 0) copied = { kind: "bodies", part: extract(document.data, selectedBodies()) };
  else return;
  pasted = 0;
  const text = JSON.stringify({ [KEYS[copied.kind]]: copied.part }, null, 1);
  void navigator.clipboard?.writeText(text).catch(() => undefined);
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
  } else if (given.kind === "blocks") await insertBlocks(given.part);
  else await insert(given.part);
}

async function insert(part: Part): Promise<void> {
  let added: string[] = [];
  const isDone = await editInTurn(() => {
    const { edits, bodies } = insertion(now().document?.data ?? {}, part);
    added = [...bodies.values()];
    return { label: `insert ${part.name}`, edits };
  });
  if (isDone) choose(added);
}

async function insertBlocks(part: BlockPart): Promise<void> {
  pasted += 1;
  const shift = SHIFT * pasted;
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
  update({ selected: ids, sight: ids[0] === undefined ? null : { id: ids[0] } });
}

function choose(bodies: readonly string[]): void {
  const ids = bodies.map((name) => `bodies/${name}`);
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
