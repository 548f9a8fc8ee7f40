import { createElement } from "react";
import { renderToStaticMarkup } from "react-dom/server";
import { expect, test, vi } from "vitest";

import published from "../../../../description/yaml/schema.json";
import type { Document, Json, JsonMap, Key, Path } from "../src/api/types";
import { at, isMap, mapAt, replaced } from "../src/model/paths";
import { ENTRIES, SYSTEM, TABLES } from "../src/model/sections";
import { type State, update } from "../src/store/store";
import { Properties } from "../src/windows/Properties";

const drawn = vi.hoisted(() => new Set<string>());
vi.mock("../src/api/client", () => ({ post: vi.fn() }));
// Pages that are drawn once, as text, see what the store began with: here, what it knows now.
vi.mock("../src/store/store", async (load) => {
  const real = await load<typeof import("../src/store/store")>();
  const useStore = Object.assign((pick: (state: State) => unknown) => pick(real.now()), real.useStore);
  return { ...real, useStore, useDocument: () => real.now().document };
});
// Every element of a form that is drawn has the path of its entry.
vi.mock("react/jsx-dev-runtime", async (load) => {
  const real = await load<typeof import("react/jsx-dev-runtime")>();
  const jsxDEV: typeof real.jsxDEV = (type, props, ...more) => {
    const { path } = props as { path?: Path };
    if (Array.isArray(path)) drawn.add(path.map(star).join("."));
    return real.jsxDEV(type, props, ...more);
  };
  return { ...real, jsxDEV };
});

/** Names and places of entries, all as one; a name of these documents is `n` with a number. */
const star = (key: Key): string => (/^n?\d+$/.test(String(key)) ? "*" : String(key));

const root = published as unknown as JsonMap;

// The version of the format; a section that no file may have yet.
const WITHOUT = ["symofros", "options"];
const BY_TABLE = [
  "parameters.*.value",
  "parameters.*.unit",
  "parameters.*.constant",
  "inputs.*.unit",
  "inputs.*.description",
];

/** What a window does not reach, and why. */
const AS_TEXT: Record<string, string> = {
  "parameters.*.description": "words for people, which the table of parameters does not show",
};

/** A schema without references and without null: each way of `anyOf`. */
function ways(schema: JsonMap): JsonMap[] {
  if (schema["$ref"] === "#/$defs/Formula") return [{ formula: true }];
  if (typeof schema["$ref"] === "string") return ways(mapAt(root, ["$defs", schema["$ref"].replace("#/$defs/", "")]));
  if (Array.isArray(schema["anyOf"])) return schema["anyOf"].filter(isMap).flatMap(ways);
  return schema["type"] === "null" ? [] : [schema];
}

const inner = (schema: JsonMap): [string, JsonMap][] => {
  const names = mapAt(schema, ["propertyNames"])["enum"];
  const more = mapAt(schema, ["additionalProperties"]);
  const own = Object.entries(mapAt(schema, ["properties"])) as [string, JsonMap][];
  const named = (Array.isArray(names) ? names : []).map((name): [string, JsonMap] => [String(name), more]);
  return [
    ...own,
    ...(named.length > 0 ? named : Object.keys(more).length > 0 ? [["*", more] as [string, JsonMap]] : []),
  ];
};

/** Paths of all properties below a schema; parts of an array of formulas or numbers are no entries. */
function paths(schema: JsonMap, place: string): string[] {
  return ways(schema).flatMap((way) => [
    ...inner(way).flatMap(([name, each]) => [`${place}.${name}`, ...paths(each, `${place}.${name}`)]),
    ...(isMap(way["items"]) ? ways(way["items"]) : []).flatMap((item) => paths(item, `${place}.*`)),
  ]);
}

/** Entries that have, together, all that the schema lets them have: one for each of several ways or words. */
function full(schema: JsonMap): Json[] {
  return ways(schema).flatMap((way): Json[] => {
    if (Array.isArray(way["enum"])) return way["enum"];
    const parts = inner(way).map(([name, each]) => [name, full(each)] as const);
    if (way["maxProperties"] === 1) return parts.flatMap(([name, all]) => all.map((each) => ({ [name]: each })));
    if (parts.length === 1 && parts[0]?.[0] === "*")
      return [Object.fromEntries(parts[0][1].map((each, i) => [`n${i}`, each]))];
    if (way["type"] === "object") {
      const base = Object.fromEntries(parts.map(([name, all]) => [name, all[0] ?? null]));
      return [base, ...parts.flatMap(([name, all]) => all.slice(1).map((each) => ({ ...base, [name]: each })))];
    }
    if (way["type"] !== "array") return [way["type"] === "boolean" ? true : way["type"] === "string" ? "n0" : 1];
    const items = full(mapAt(way, ["items"]));
    return [typeof way["minItems"] === "number" ? Array.from({ length: way["minItems"] }, () => items[0] ?? 0) : items];
  });
}

const without = (value: Json, ...keys: string[]): JsonMap =>
  Object.fromEntries(Object.entries(mapAt(value, [])).filter(([key]) => !keys.includes(key)));

/** What excludes each other, though the schema says it in words only. */
const APART: Record<string, readonly string[][]> = {
  bodies: [["beam"], ["beam", "solid"], ["beam", "inertia"], ["joint", "beam"]],
  contacts: [["stiffness"]],
  nonholonomic: [["knife_edge"], ["knife_edge", "rolling"]],
};

/** The pages of a body's window, by an entry that each shows; and what each depends on. */
const PAGES: Record<string, string[]> = {
  joint: ["joint"],
  beam: ["beam", "solid", "inertia"],
  frames: ["frames"],
  loads: ["joint", "loads", "beam"],
};

test("every key of the format is reached by a window or a table", () => {
  const schemas = mapAt(root, ["properties"]);
  const entries = (section: string): Json[] => {
    const [map] = ways(mapAt(schemas, [section]));
    const all = full(mapAt(map, ["additionalProperties"]));
    const bare = all.filter((each) => isMap(each) && isMap(each["beam"]));
    return [
      ...all,
      ...(APART[section] ?? []).flatMap((keys) => all.map((each) => without(each, ...keys))),
      ...bare.slice(0, 1).map((each) => replaced(each, "beam", without(mapAt(each, ["beam"]), "section"))),
    ];
  };
  const named = (all: Json[]): JsonMap => Object.fromEntries(all.map((each, i) => [`n${i}`, each]));
  const data: JsonMap = {
    ...Object.fromEntries(SYSTEM.map((key) => [key, full(mapAt(schemas, [key]))[0] ?? null])),
    ...Object.fromEntries(ENTRIES.map((section) => [section, named(entries(section))])),
  };
  const document = { data, diagram: null, problems: [], parameters: [], inputs: [], graph: { nodes: [], edges: [] } };
  update({
    document: document as unknown as Document,
    catalogue: { schema: root, sizes: {}, diagram: { palette: [] } } as never,
  });
  const draw = (path: Path, entry: Path = []): string =>
    renderToStaticMarkup(createElement(Properties, { path, entry }));
  draw(["system"]);
  const seen = new Set<string>();
  for (const section of ENTRIES) {
    for (const [name, entry] of Object.entries(mapAt(data, [section]))) {
      for (const [page, keys] of section === "bodies" ? Object.entries(PAGES) : [["", [] as string[]] as const]) {
        const shown = JSON.stringify([section, page, keys.length === 0 ? entry : keys.map((key) => at(entry, [key]))]);
        if (!seen.has(shown)) draw([section, name], page === "" ? [] : [page]);
        seen.add(shown);
      }
    }
  }
  const known = [...ENTRIES, ...SYSTEM, ...TABLES, ...WITHOUT];
  expect(known.sort()).toEqual(Object.keys(schemas).sort());
  const all = new Set(Object.entries(schemas).flatMap(([name, schema]) => paths(schema as JsonMap, name)));
  // A name of the author's own is typed where its entry is added.
  const left = [...all].filter((path) => !path.endsWith(".*") && !drawn.has(path) && !BY_TABLE.includes(path));
  expect(left.sort()).toEqual(Object.keys(AS_TEXT).sort());
}, 60_000);
