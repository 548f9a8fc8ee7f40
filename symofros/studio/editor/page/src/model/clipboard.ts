/** Copies of bodies and of what acts between them, and how they are put into a document: with fresh names. */

import type { Edit, Json, JsonMap, Part } from "../api/types";
import { bodyNames, fresh, jointName, namesIn, renamed, symbols } from "./names";
import { isMap, mapAt, textAt } from "./paths";
import { bodiesIn, LINKING } from "./uses";

function usedNames(value: Json): string[] {
  if (typeof value === "string") return namesIn(value);
  if (Array.isArray(value)) return value.flatMap(usedNames);
  return isMap(value) ? Object.values(value).flatMap(usedNames) : [];
}

const chosen = (map: JsonMap, keep: (name: string, value: Json) => boolean): JsonMap =>
  Object.fromEntries(Object.entries(map).filter(([name, value]) => keep(name, value)));

/** The chosen bodies and links, links of these bodies to each other and to the ground, and what all of them use. */
export function extract(data: JsonMap, ids: readonly string[]): Part {
  const moves = (name: string): boolean => isMap(mapAt(data, ["bodies", name])["joint"]);
  const bodies = chosen(mapAt(data, ["bodies"]), (name) => ids.includes(`bodies/${name}`) && moves(name));
  const belongs = (link: Json): boolean => {
    const ends = bodiesIn(link);
    return ends.some((end) => end in bodies) && ends.every((end) => end in bodies || !moves(end));
  };
  const links: JsonMap = {};
  for (const section of LINKING)
    links[section] = chosen(
      mapAt(data, [section]),
      (name, link) => ids.includes(`${section}/${name}`) || belongs(link),
    );
  const linked = Object.values(links).flatMap((entries) => Object.keys(entries ?? {}));
  const switches = chosen(mapAt(data, ["switches"]), (name) => linked.includes(name));
  const used = new Set(usedNames({ bodies, links, switches }));
  const ofSection = (section: string): JsonMap => chosen(mapAt(data, [section]), (name) => used.has(name));
  return {
    name: [...Object.keys(bodies), ...linked][0] ?? "",
    ground: bodyNames(data).find((name) => !moves(name)) ?? "world",
    bodies,
    links,
    switches,
    parameters: ofSection("parameters"),
    inputs: ofSection("inputs"),
  };
}

/** Names of joints in a part that every part gives, so that two copies do not share a coordinate. */
function jointNames(part: Part, taken: string[]): Map<string, string> {
  const names = new Map<string, string>();
  for (const body of Object.keys(part.bodies)) {
    const old = textAt(part.bodies, [body, "joint", "name"]);
    if (old === undefined) continue;
    const name = fresh(old, [...taken, ...names.values()]);
    names.set(old, name);
    names.set(`d${old}`, `d${name}`);
  }
  return names;
}

function mounted(body: Json, names: ReadonlyMap<string, string>, known: Set<string>): Json {
  if (!isMap(body) || !isMap(body["joint"])) return body;
  const { parent, frame, ...joint } = body["joint"];
  const inside = typeof parent === "string" ? names.get(parent) : undefined;
  if (inside === undefined && !(typeof parent === "string" && known.has(parent))) return { ...body, joint };
  const place: JsonMap = { parent: inside ?? parent ?? "world" };
  if (frame !== undefined) place["frame"] = frame;
  return { ...body, joint: { ...joint, ...place } };
}

/** A link whose ends are on other bodies. */
function anchored(link: Json, names: ReadonlyMap<string, string>): Json {
  if (!isMap(link)) return link;
  const end = (key: string, item: Json): Json =>
    key === "body" && typeof item === "string" ? (names.get(item) ?? item) : anchored(item, names);
  return Object.fromEntries(Object.entries(link).map(([key, item]) => [key, end(key, item)]));
}

/** Edits that put a part into a document, and the ids of what they add. Parameters that are there are shared. */
export function insertion(data: JsonMap, part: Part): { edits: Edit[]; ids: string[] } {
  const known = new Set(bodyNames(data));
  const bodies = new Map<string, string>();
  for (const old of Object.keys(part.bodies)) bodies.set(old, fresh(old, [...known, ...bodies.values()]));
  const joints = jointNames(part, [...symbols(data), ...[...known].map((body) => jointName(data, body))]);

  const missing = (section: "parameters" | "inputs"): Edit[] =>
    Object.entries(part[section])
      .filter(([name]) => !(name in mapAt(data, [section])))
      .map(([name, value]) => ({ op: "set", path: [section, name], value }));
  const added = Object.entries(part.bodies).map(([old, value]): Edit => {
    const body = mounted(renamed(value, joints), bodies, known);
    return { op: "set", path: ["bodies", bodies.get(old) ?? old], value: body };
  });
  const ends = new Map([...(known.has(part.ground) ? [] : [[part.ground, "world"] as const]), ...bodies]);
  const switches: Edit[] = [];
  // A switch names its constraint, of whatever section.
  const taken = [...LINKING, "switches"].flatMap((section) => Object.keys(mapAt(data, [section])));
  const links = LINKING.flatMap((section) =>
    Object.entries(mapAt(part.links, [section])).map(([old, value]): Edit => {
      const name = fresh(old, taken);
      taken.push(name);
      const held = part.switches[old];
      if (held !== undefined) switches.push({ op: "set", path: ["switches", name], value: held });
      return { op: "set", path: [section, name], value: anchored(renamed(value, joints), ends) };
    }),
  );
  const ids = [...added, ...links].map(({ path }) => path.join("/"));
  return { edits: [...missing("parameters"), ...missing("inputs"), ...added, ...links, ...switches], ids };
}
