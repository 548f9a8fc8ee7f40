import { describe, expect, test } from "vitest";

import type { Document, GraphNode } from "../src/api/types";
import { drawing } from "../src/model/drawing";
import { everything, search } from "../src/model/search";

const ports = [
  { name: "root", kind: "root" as const },
  { name: "body", kind: "origin" as const },
  { name: "tip", kind: "frame" as const },
];
const block = (name: string): GraphNode => ({
  id: `bodies/${name}`,
  kind: "rigid_body",
  title: name,
  subtitle: "",
  path: ["bodies", name],
  ports,
  problems: 0,
});

const document: Document = {
  path: "a.yaml",
  name: "a.yaml",
  revision: 1,
  dirty: false,
  step: 0,
  can_undo: false,
  can_redo: false,
  undo_label: null,
  redo_label: null,
  text: "",
  data: {
    bodies: {
      "a<b": { joint: { name: "q1", kind: "revolute" }, inertia: { mass: 2 }, frames: { tip: {} } },
      boom: { joint: { kind: "fixed", parent: "a<b" }, beam: { bend_y: 2 } },
    },
    parameters: { tipmass: 1 },
  },
  layout: {},
  diagram: null,
  undrawn: 0,
  trail: [],
  graph: {
    nodes: [block("a<b"), block("boom")],
    edges: [
      {
        id: "closures/x",
        kind: "closure",
        source: "bodies/a<b",
        source_port: "tip",
        target: "bodies/boom",
        target_port: "body",
        path: ["closures", "x"],
        label: "x & y",
      },
    ],
  },
  problems: [],
  parameters: [],
  inputs: [],
  lines: {},
  recovered: false,
  disk_changed: false,
  unkept: null,
};

describe("the picture", () => {
  const svg = drawing(document, { "bodies/a<b": [0, 0], "bodies/boom": [300, -40] });

  test("has every block and link, with names as text", () => {
    expect(svg.match(/<g transform/g)).toHaveLength(2);
    expect(svg).toContain("a&#60;b");
    expect(svg).toContain("x &#38; y");
    expect(svg).not.toContain("a<b");
  });

  test("holds all of it", () => {
    const [left, top, width, height] = (/viewBox="([^"]+)"/.exec(svg)?.[1] ?? "").split(" ").map(Number) as [
      number,
      number,
      number,
      number,
    ];
    expect(left).toBeLessThan(0);
    expect(top).toBeLessThan(-40);
    expect(left + width).toBeGreaterThan(300 + 196);
    expect(top + height).toBeGreaterThan(60);
  });
});

test("finding goes by all words, names that begin so first", () => {
  const hits = everything(document);
  expect(search(hits, "tip").map(({ name, what }) => `${what} ${name}`)).toEqual([
    "frame of a<b tip",
    "frame of boom tip",
    "parameter tipmass",
  ]);
  expect(search(hits, "frame boom")).toHaveLength(1);
  expect(search(hits, "nothing")).toEqual([]);
});
