/** Copies of a diagram's blocks, and how they are put into a diagram: with fresh names, wired to each other as before. */

import type { Edit, Json, JsonMap, Point } from "../api/types";
import { fresh } from "./names";
import { isMap, mapAt, textAt } from "./paths";

const SECTIONS = ["models", "blocks", "parts"] as const;
type Section = (typeof SECTIONS)[number];

/** Blocks on their way from one diagram to another. */
export interface BlockPart {
  models: JsonMap;
  blocks: JsonMap;
  parts: JsonMap;
  /** Wires that stand in a section of their own: to inputs of blocks inside parts. */
  wires: JsonMap;
  /** Models that were chosen themselves, and not only named by a block. */
  chosen: string[];
  /** Places of what was chosen, by its id. */
  places: Record<string, Point>;
}

/** The block or part that a signal's name begins with. */
const owner = (signal: string): string => {
  const inside = signal.indexOf("/");
  return inside >= 0 ? signal.slice(0, inside) : (signal.split(".", 1)[0] ?? signal);
};

/** Entries of a mapping whose values are signals of some blocks. */
const fedBy = (inputs: Json | undefined, names: ReadonlyMap<string, string>): JsonMap =>
  Object.fromEntries(
    Object.entries(isMap(inputs) ? inputs : {}).flatMap(([port, source]) => {
      const name = typeof source === "string" ? names.get(owner(source)) : undefined;
      return typeof source === "string" && name !== undefined
        ? [[port, name + source.slice(owner(source).length)]]
        : [];
    }),
  );

/** The chosen blocks, parts and models, with the models that blocks name. */
export function extractBlocks(data: JsonMap, ids: readonly string[], places: Record<string, Point>): BlockPart {
  const ofSection = (section: Section): JsonMap =>
    Object.fromEntries(Object.entries(mapAt(data, [section])).filter(([name]) => ids.includes(`${section}/${name}`)));
  const [blocks, parts, models] = [ofSection("blocks"), ofSection("parts"), ofSection("models")];
  const named = Object.values(blocks).flatMap((block) => textAt(block, ["model"]) ?? []);
  const needed = Object.entries(mapAt(data, ["models"])).filter(([name]) => named.includes(name));
  const wires = Object.entries(mapAt(data, ["wires"])).filter(([target]) => {
    const name = owner(target);
    return name in blocks || name in parts;
  });
  return {
    models: { ...Object.fromEntries(needed), ...models },
    blocks,
    parts,
    wires: Object.fromEntries(wires),
    chosen: Object.keys(models),
    places: Object.fromEntries(ids.flatMap((id) => (places[id] === undefined ? [] : [[id, places[id]]]))),
  };
}

/** Fresh names for some entries. */
function freshNames(names: readonly string[], taken: readonly string[]): Map<string, string> {
  const given = new Map<string, string>();
  for (const name of names) given.set(name, fresh(name, [...taken, ...given.values()]));
  return given;
}

/** Edits that put blocks into a diagram, and where they are put: beside the originals. Models there are shared. */
export function blockInsertion(
  data: JsonMap,
  part: BlockPart,
  shift: number,
): { edits: Edit[]; places: Record<string, Point> } {
  const known = mapAt(data, ["models"]);
  const models = freshNames(part.chosen, Object.keys(known));
  const names = freshNames(
    [...Object.keys(part.blocks), ...Object.keys(part.parts)],
    [...Object.keys(mapAt(data, ["blocks"])), ...Object.keys(mapAt(data, ["parts"]))],
  );
  const put = (section: Section, renamed: ReadonlyMap<string, string>): Edit[] =>
    Object.entries(part[section]).map(([old, value]): Edit => {
      const model = models.get(textAt(value, ["model"]) ?? "");
      const entry: Json = isMap(value) ? { ...value } : value;
      if (isMap(entry) && "inputs" in entry) entry["inputs"] = fedBy(entry["inputs"], names);
      if (isMap(entry) && model !== undefined) entry["model"] = model;
      return { op: "set", path: [section, renamed.get(old) ?? old], value: entry };
    });
  const added = put("models", models).filter(({ path }) => !(String(path[1]) in known));
  const wires = Object.entries(fedBy(part.wires, names)).map(([target, source]): Edit => {
    const renamed = `${names.get(owner(target)) ?? ""}${target.slice(owner(target).length)}`;
    return { op: "set", path: ["wires", renamed], value: source };
  });
  const places = Object.entries(part.places).flatMap(([id, place]) => {
    // The text of a clipboard may be anybody's.
    if (!Array.isArray(place) || place.length !== 2 || !place.every(Number.isFinite)) return [];
    const [x, y] = place as [number, number];
    const [section, old] = [id.slice(0, id.indexOf("/")), id.slice(id.indexOf("/") + 1)];
    const name = (section === "models" ? models : names).get(old);
    return name === undefined ? [] : [[`${section}/${name}`, [x + shift, y + shift]] as const];
  });
  return {
    edits: [...added, ...put("blocks", names), ...put("parts", names), ...wires],
    places: Object.fromEntries(places),
  };
}
