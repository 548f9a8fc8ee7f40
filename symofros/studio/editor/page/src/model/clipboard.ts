/** Copies of bodies, and how they are put into a document: with fresh names, linked to each other as they were. */

import type { Edit, Json, JsonMap, Part } from "../api/types";
import { bodyNames, fresh, jointName, namesIn, renamed, symbols } from "./names";
import { isMap, mapAt, textAt } from "./paths";

function usedNames(value: Json): string[] {
  if (typeof value === "string") return namesIn(value);
  if (Array.isArray(value)) return value.flatMap(usedNames);
  return isMap(value) ? Object.values(value).flatMap(usedNames) : [];
}

const chosen = (map: JsonMap, keep: (name: string, value: Json) => boolean): JsonMap =>
  Object.fromEntries(Object.entries(map).filter(([name, value]) => keep(name, value)));

function within(closure: Json, bodies: Set<string>): boolean {
  return ["first", "second"].every((end) => bodies.has(textAt(closure, [end, "body"]) ?? ""));
}

/** The named bodies, closures between them, and the parameters and inputs that they use. */
export function extract(data: JsonMap, names: string[]): Part {
  const wanted = new Set(names);
  const bodies = chosen(mapAt(data, ["bodies"]), (name) => wanted.has(name));
  const closures = chosen(mapAt(data, ["closures"]), (_, value) => within(value, wanted));
  const used = new Set([...usedNames(bodies), ...usedNames(closures)]);
  const ofSection = (section: string): JsonMap => chosen(mapAt(data, [section]), (name) => used.has(name));
  return {
    name: names[0] ?? "part",
    bodies,
    closures,
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

function anchored(closure: Json, names: ReadonlyMap<string, string>): Json {
  const end = (key: string): JsonMap => {
    const anchor = mapAt(closure, [key]);
    return { ...anchor, body: names.get(textAt(anchor, ["body"]) ?? "") ?? null };
  };
  return isMap(closure) ? { ...closure, first: end("first"), second: end("second") } : closure;
}

/** Edits that put a part into a document, and the names its bodies have there. Parameters that are there are shared. */
export function insertion(data: JsonMap, part: Part): { edits: Edit[]; bodies: Map<string, string> } {
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
  const taken = Object.keys(mapAt(data, ["closures"]));
  const closures = Object.entries(part.closures).map(([old, value]): Edit => {
    const name = fresh(old, taken);
    taken.push(name);
    return { op: "set", path: ["closures", name], value: anchored(value, bodies) };
  });
  return { edits: [...missing("parameters"), ...missing("inputs"), ...added, ...closures], bodies };
}
