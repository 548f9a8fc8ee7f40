import { describe, expect, test } from "vitest";

import published from "../../../../description/yaml/schema.json";
import type { Edit, Graph, GraphNode, Json, JsonMap, Port } from "../src/api/types";
import { beamGroups } from "../src/forms/beam";
import { definition, field } from "../src/forms/schema";
import { shown, typed } from "../src/forms/values";
import { changes, keyOf } from "../src/model/changes";
import { extract, insertion } from "../src/model/clipboard";
import { size } from "../src/model/geometry";
import { completed, tidy } from "../src/model/layout";
import { merged } from "../src/model/merge";
import { fresh } from "../src/model/names";
import { difference, isMap } from "../src/model/paths";
import { line, span, ticks, within } from "../src/model/plot";
import { csv } from "../src/model/table";
import { asked, fitted } from "../src/model/sizes";

const arm: JsonMap = {
  parameters: { m: { value: 1 }, L: 2, unused: 3 },
  bodies: {
    upper: {
      joint: { name: "q1", kind: "revolute" },
      inertia: { mass: "m" },
      frames: { tip: { position: ["L", 0, 0] } },
    },
    lower: {
      joint: { name: "q2", kind: "revolute", parent: "upper", frame: "tip", effort: ["-m*dq2"] },
      inertia: { mass: "m" },
    },
  },
  closures: { loop: { first: { body: "upper", frame: "tip" }, second: { body: "lower" } } },
};

/** What edits make of plain data: sets and removals only. */
function applied(data: Json, edits: readonly Edit[]): Json {
  const copy = structuredClone(data);
  for (const edit of edits) {
    let place: Json = copy;
    for (const key of edit.path.slice(0, -1)) place = (place as JsonMap)[String(key)] as Json;
    const last = String(edit.path.at(-1));
    if (edit.op === "set" && "value" in edit) (place as JsonMap)[last] = edit.value;
    else if (edit.op === "remove") delete (place as JsonMap)[last];
  }
  return copy;
}

describe("difference", () => {
  test.each<[Json, Json, number]>([
    [{ a: 1, b: [1, 2] }, { a: 1, b: [1, 3] }, 1],
    [{ a: 1, b: 2 }, { b: 2 }, 1],
    [{ a: [1, 2] }, { a: [1, 2, 3] }, 1],
    [{ a: { b: { c: 1 } } }, { a: { b: { c: 2, d: 3 } } }, 2],
    [{ a: 1 }, { a: { b: 1 } }, 1],
    [{ a: 1 }, { a: 1 }, 0],
  ])("%j -> %j takes %i edits", (before, after, count) => {
    const edits = difference(before, after, []);
    expect(edits).toHaveLength(count);
    expect(applied(before, edits)).toEqual(after);
  });
});

describe("changes of a window", () => {
  const before = (arm["bodies"] as JsonMap)["upper"] as JsonMap;
  const path = ["bodies", "upper"];

  test("names come first, from the inside out, and values go to the new places", () => {
    const after = { ...before, joint: { name: "hip", kind: "revolute" }, frames: { tip: { position: [1, 0, 0] } } };
    const renames = { [keyOf(path)]: "boom", [keyOf([...path, "frames", "tip"])]: "end" };
    expect(changes(path, before, after, renames)).toEqual([
      { op: "rename", path: [...path, "frames", "tip"], to: "end" },
      { op: "rename", path: [...path, "joint"], to: "hip" },
      { op: "rename", path, to: "boom" },
      { op: "set", path: ["bodies", "boom", "frames", "end", "position", 0], value: 1 },
    ]);
  });

  test("a number keeps the figures that it was typed with, as long as it is that number", () => {
    const place = ["bodies", "upper", "inertia", "mass"];
    const after = { ...before, inertia: { mass: 0.0008 } };
    const as = (text: string): Edit[] => changes(path, before, after, {}, new Map([[keyOf(place), text]]));
    expect(as("8.0e-4")).toEqual([{ op: "set", path: place, text: "8.0e-4" }]);
    expect(as("8.0e-5")).toEqual([{ op: "set", path: place, value: 0.0008 }]);
  });

  test("a name that was typed back is no change", () => {
    expect(changes(path, before, before, { [keyOf(path)]: "upper" })).toEqual([]);
  });
});

describe("copies", () => {
  const both = ["bodies/upper", "bodies/lower"];

  test("take what they use, and nothing else", () => {
    const part = extract(arm, both);
    expect(Object.keys(part.parameters)).toEqual(["m", "L"]);
    expect(Object.keys(part.links["closures"] ?? {})).toEqual(["loop"]);
    expect(extract(arm, ["bodies/lower"]).links["closures"]).toEqual({});
    expect(extract(arm, ["bodies/lower/joint"]).name).toBe("");
  });

  test("have bodies, coordinates and links of their own", () => {
    const { edits, ids } = insertion(arm, extract(arm, both));
    expect(ids).toEqual(["bodies/upper2", "bodies/lower2", "closures/loop2"]);
    const made = applied(arm, edits) as {
      bodies: Record<string, { joint: JsonMap }>;
      closures: JsonMap;
      parameters: Json;
    };
    expect(made.parameters).toEqual(arm["parameters"]);
    expect(made.bodies["lower2"]?.joint).toEqual({
      name: "q4",
      kind: "revolute",
      parent: "upper2",
      frame: "tip",
      effort: ["-m*dq4"],
    });
    expect(made.closures["loop2"]).toEqual({ first: { body: "upper2", frame: "tip" }, second: { body: "lower2" } });
  });

  const rig: JsonMap = {
    ...arm,
    bodies: { base: { frames: { hook: {} } }, ...(arm["bodies"] as JsonMap) },
    connections: { cable: { first: { body: "base", frame: "hook" }, second: { body: "lower" }, law: "L*q2" } },
    contacts: { touch: { first: { body: "lower" }, second: { body: "base" }, radius: "unused" } },
    nonholonomic: { blade: { knife_edge: { body: "upper", axis: "y" } } },
    switches: { loop: { engaged: 1 }, blade: { engaged: 0 } },
  };

  test("of bodies take links with the ground, and their switches", () => {
    const { edits, ids } = insertion(rig, extract(rig, both));
    expect(ids.slice(2)).toEqual(["closures/loop2", "connections/cable2", "contacts/touch2", "nonholonomic/blade2"]);
    const made = applied(rig, edits) as Record<string, Record<string, JsonMap>>;
    expect(made["connections"]?.["cable2"]).toEqual({
      first: { body: "base", frame: "hook" },
      second: { body: "lower2" },
      law: "L*q4",
    });
    expect(made["contacts"]?.["touch2"]?.["first"]).toEqual({ body: "lower2" });
    expect(made["nonholonomic"]?.["blade2"]).toEqual({ knife_edge: { body: "upper2", axis: "y" } });
    expect(made["switches"]).toEqual({
      ...(rig["switches"] as JsonMap),
      loop2: { engaged: 1 },
      blade2: { engaged: 0 },
    });
    expect(extract(rig, ["bodies/upper"]).links["connections"]).toEqual({});
  });

  test("of a link alone join the same bodies; the ground is that of the document", () => {
    const part = extract(rig, ["contacts/touch"]);
    expect(part.parameters).toEqual({ unused: 3 });
    const { edits, ids } = insertion(rig, part);
    expect(ids).toEqual(["contacts/touch2"]);
    expect(edits).toEqual([{ op: "set", path: ["contacts", "touch2"], value: (rig["contacts"] as JsonMap)["touch"] }]);
    const [, elsewhere] = insertion({ bodies: { lower: {} } }, part).edits;
    expect(elsewhere).toMatchObject({ path: ["contacts", "touch"], value: { second: { body: "world" } } });
  });
});

test.each([
  ["body", [], "body"],
  ["body", ["body"], "body2"],
  ["q1", ["q1", "q2"], "q3"],
  ["link_9", ["link_9"], "link2"],
])("fresh name of %s beside %j is %s", (stem, taken, expected) => {
  expect(fresh(stem, taken)).toBe(expected);
});

function chain(count: number, fan = 1): Graph {
  const ports: Port[] = [
    { name: "root", kind: "root" },
    { name: "body", kind: "origin" },
    { name: "tip", kind: "frame" },
  ];
  const nodes = Array.from({ length: count }, (_, i): GraphNode => ({
    id: `bodies/b${i}`,
    kind: "rigid_body",
    title: `b${i}`,
    subtitle: "",
    path: ["bodies", `b${i}`],
    ports,
    problems: 0,
  }));
  const edges = nodes.slice(1).map((node, i) => ({
    id: `${node.id}/joint`,
    kind: "joint" as const,
    source: `bodies/b${Math.floor(i / fan)}`,
    source_port: "tip",
    target: node.id,
    target_port: "root",
    path: [...node.path, "joint"],
    label: "",
  }));
  return { nodes, edges };
}

function overlapping(graph: Graph, places: Record<string, readonly [number, number]>): string[] {
  const boxes = graph.nodes.map((node) => ({ id: node.id, at: places[node.id] ?? [NaN, NaN], size: size(node) }));
  return boxes.flatMap((a, i) =>
    boxes
      .slice(i + 1)
      .filter((b) =>
        [0, 1].every(
          (k) =>
            !(
              (a.at[k] ?? 0) + (a.size[k] ?? 0) <= (b.at[k] ?? 0) || (b.at[k] ?? 0) + (b.size[k] ?? 0) <= (a.at[k] ?? 0)
            ),
        ),
      )
      .map((b) => `${a.id} ${b.id}`),
  );
}

describe("layout", () => {
  test.each([[chain(1)], [chain(3)], [chain(30)], [chain(40, 3)], [chain(25, 24)]])(
    "puts every block clear of the others",
    (graph) => {
      const places = tidy(graph);
      expect(Object.keys(places)).toHaveLength(graph.nodes.length);
      expect(overlapping(graph, places)).toEqual([]);
    },
  );

  test("a long chain is as wide as a screen, not a line", () => {
    const places = Object.values(tidy(chain(30)));
    expect(Math.max(...places.map(([x]) => x))).toBeLessThan(2500);
  });

  test("a loop of parents in a broken document is laid out too", () => {
    const graph = chain(3);
    const back = { ...graph.edges[0]!, id: "back", source: "bodies/b2", target: "bodies/b0" };
    expect(Object.keys(tidy({ ...graph, edges: [...graph.edges, back] }))).toHaveLength(3);
  });

  test("a name that is used again does not put its block onto another", () => {
    const graph = chain(2);
    const places = completed(graph, { "bodies/b0": [0, 0] }, { "bodies/b1": [20, 20] });
    expect(overlapping(graph, places)).toEqual([]);
    expect(completed(graph, { "bodies/b0": [0, 0] }, { "bodies/b1": [20, 300] })["bodies/b1"]).toEqual([20, 300]);
  });

  test("blocks that have places keep them", () => {
    const graph = chain(4);
    const known = { "bodies/b0": [0, 0], "bodies/b1": [10, 500] } as const;
    const places = completed(graph, known);
    expect(places).toMatchObject(known);
    expect(overlapping(graph, places)).toEqual([]);
  });
});

describe("schema", () => {
  const root = published as unknown as JsonMap;
  const definitions = Object.keys(root["$defs"] as JsonMap).filter((name) => name !== "Formula");

  test.each(definitions)("%s: every property has a control that suits it", (name) => {
    const { shape } = definition(root, name);
    expect(["record", "one of"]).toContain(shape.kind);
    if (shape.kind !== "record" && shape.kind !== "one of") return;
    for (const [key, schema] of Object.entries(shape.properties)) {
      const described = field(root, schema as JsonMap);
      // A text is the last resort: only properties that are names or words may end there.
      if (described.shape.kind === "text")
        expect(`${name}.${key}`).toMatch(/\.(name|parent|frame|body|carrier|at|unit|description)$/);
    }
  });

  test("units come out of the descriptions", () => {
    const { shape } = definition(root, "BeamEntry");
    const units =
      shape.kind === "record"
        ? Object.entries(shape.properties).map(([key, schema]) => [key, isMap(schema) ? field(root, schema).unit : ""])
        : [];
    expect(Object.fromEntries(units)).toMatchObject({
      length: "m",
      rhoA: "kg/m",
      EI_z: "N m^2",
      damping: "s",
      family: "",
    });
  });

  test("the window of a beam shows every property of the schema once", () => {
    const { shape } = definition(root, "BeamEntry");
    if (shape.kind !== "record") throw new Error("a beam is a record");
    const { shapeFunctions, section, formulas, model } = beamGroups(root, shape.properties, "user");
    // `section` takes the place of the properties of the section, by the choice above them.
    const shown = [...shapeFunctions, ...section, ...formulas, ...model, "section"];
    expect(shown.sort()).toEqual(Object.keys(shape.properties).sort());
    expect(formulas).toEqual(expect.arrayContaining(["length", "damping"]));
    expect(section).toContain("rhoI_y");
    expect(shapeFunctions).toEqual(expect.arrayContaining(["stretch", "shear_y", "shear_z"]));
    expect(beamGroups(root, shape.properties, "spline").shapeFunctions).not.toContain("shapes");
  });
});

test.each([
  ["1.50", 1.5],
  ["-2e-3", -0.002],
  [" L1/2 ", "L1/2"],
  ["1e", "1e"],
  ["  ", undefined],
])("typed %j means %j", (text, value) => {
  expect(typed(text)).toEqual(value);
});

test.each([
  [1.2e-5, "1.2e-5"],
  [0.02, "0.02"],
  [0, "0"],
  ["L1", "L1"],
])("%j is shown as %j", (value, text) => {
  expect(shown(value)).toBe(text);
});

describe("texts changed at two places", () => {
  test.each([
    ["a b c", "a B c", "a b C", "a B C"],
    ["a b c", "a b C", "A b c", "A b C"],
    ["a b c", "a b cc", "aaa b c", "aaa b cc"],
    ["a b c", "a c", "a b c d", "a c d"],
    ["a b c", "a X c", "a Y c", "a X c"],
    ["a b c", "a b c", "a Y c", "a Y c"],
    ["a b c", "a X c", "a b c", "a X c"],
    ["a b c", "a b c", "a b c", "a b c"],
  ])("%j: mine %j and theirs %j is %j", (base, mine, theirs, expected) => {
    expect(merged(base, mine, theirs)).toBe(expected);
  });
});

describe("plots", () => {
  test("a part of a curve has the points beside it", () => {
    const x = [0, 1, 2, 3, 4];
    const y = [0, 10, 20, 30, 40];
    expect(within(x, y, null).x).toBe(x);
    expect(within(x, y, [1.5, 2.5])).toEqual({ x: [1, 2, 3], y: [10, 20, 30] });
    expect(within(x, y, [-1, 0.5])).toEqual({ x: [0, 1], y: [0, 10] });
    expect(within(x, y, [3.5, 9])).toEqual({ x: [3, 4], y: [30, 40] });
    expect(within(x, y, [1.2, 1.4])).toEqual({ x: [1, 2], y: [10, 20] });
  });

  test("tables are files with all digits", () => {
    const rows = [
      ['a "b", c', 0.1 + 0.2],
      ["d", null],
    ];
    expect(csv(["name", "x"], rows)).toBe('name,x\n"a ""b"", c",0.30000000000000004\nd,\n');
  });

  test.each([
    [[0, 1], 5],
    [[-3.2, 7.9], 6],
    [[1e-9, 3e-9], 4],
    [[1200, 1201], 5],
  ] as const)("ticks of %j are round and inside", ([low, high], count) => {
    const found = ticks([low, high], count);
    expect(found.length).toBeGreaterThan(1);
    expect(found.length).toBeLessThanOrEqual(count + 1);
    expect(Math.min(...found)).toBeGreaterThanOrEqual(low - 1e-12);
    expect(Math.max(...found)).toBeLessThanOrEqual(high + 1e-12);
  });

  test("a line breaks where a run diverged", () => {
    const box = { x: 0, y: 0, width: 10, height: 10 };
    expect(line([0, 1, 2, 3], [0, null, 1, 0], [0, 3], span([0, null, 1, 0]), box).match(/M/g)).toHaveLength(2);
  });

  test("constant values have a span", () => {
    expect(span([2, 2])).toEqual([0, 4]);
  });
});

describe("sizes of shapes", () => {
  const sizes = { box: ["x", "y", "z"], cylinder: ["radius", "length"], ellipsoid: ["x", "y", "z"] };
  const properties = ["shape", "density", "x", "y", "z", "radius", "length"];

  test("those of the shape alone are asked for", () => {
    expect(asked(properties, { shape: "cylinder" }, sizes)).toEqual(["shape", "density", "radius", "length"]);
    expect(asked(properties, { shape: "cone" }, sizes)).toEqual(properties);
    expect(asked(properties, {}, sizes)).toEqual(properties);
  });

  test("another shape keeps what it has, too", () => {
    const box = { density: 2700, x: 1, y: 2, z: 3 };
    expect(fitted({ shape: "ellipsoid", ...box }, sizes)).toEqual({ shape: "ellipsoid", ...box });
    expect(fitted({ shape: "cylinder", ...box }, sizes)).toEqual({ shape: "cylinder", density: 2700 });
  });
});
