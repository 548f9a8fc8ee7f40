import { describe, expect, test } from "vitest";

import type { Document, Graph } from "../src/api/types";
import { blockOf, elementAt, linesOf } from "../src/model/elements";
import { treeRows } from "../src/model/tree";

const graph: Graph = {
  nodes: [
    { id: "bodies/b", kind: "beam", title: "b", subtitle: "", path: ["bodies", "b"], ports: [], problems: 0 },
    { id: "world", kind: "base", title: "world", subtitle: "", path: ["system"], ports: [], problems: 0 },
    {
      id: "bodies/a",
      kind: "rigid_body",
      title: "a",
      subtitle: "",
      path: ["bodies", "a"],
      ports: [
        { name: "", kind: "origin" },
        { name: "tip", kind: "frame" },
      ],
      problems: 0,
    },
    { id: "bodies/lost", kind: "beam", title: "lost", subtitle: "", path: ["bodies", "lost"], ports: [], problems: 0 },
  ],
  edges: [
    ["bodies/a/joint", "joint", "world", "bodies/a", "q1"],
    ["bodies/b/joint", "joint", "bodies/a", "bodies/b", "q2"],
    ["closures/loop", "closure", "bodies/b", "world", "loop"],
  ].map(([id, kind, source, target, label]) => ({
    id: id ?? "",
    kind: kind as "joint",
    source: source ?? "",
    source_port: "",
    target: target ?? "",
    target_port: "",
    path: [],
    label: label ?? "",
  })),
};
const lines: Document["lines"] = {
  "bodies/a": [2, 9],
  "bodies/a/joint": [3, 5],
  "bodies/a/frames/tip": [7, 9],
  "bodies/b": [10, 10],
  "bodies/b/joint": [10, 10],
};

describe("what is chosen", () => {
  test("a line means the innermost element around it; of several on one line, the outermost", () => {
    expect([1, 2, 4, 6, 8, 10, 11].map((line) => elementAt(lines, line))).toEqual([
      undefined,
      "bodies/a",
      "bodies/a/joint",
      "bodies/a",
      "bodies/a/frames/tip",
      "bodies/b",
      undefined,
    ]);
  });

  test("a frame that the text leaves out has the lines of its body", () => {
    expect(linesOf(lines, "bodies/b/frames/tip")).toEqual([10, 10]);
    expect(linesOf(lines, "bodies/nobody")).toBeUndefined();
  });

  test("links and frames are of blocks", () => {
    expect(["bodies/a/frames/tip", "bodies/b/joint", "world"].map((id) => blockOf(graph, id))).toEqual([
      "bodies/a",
      "bodies/b",
      "world",
    ]);
  });

  test("the tree has bodies on what carries them, then links; nothing twice, nothing left out", () => {
    const rows = treeRows({ graph, diagram: null } as unknown as Document);
    expect(rows.map(({ id, depth }) => [id, depth])).toEqual([
      ["world", 0],
      ["bodies/a", 1],
      ["bodies/a/joint", 2],
      ["bodies/a/frames/tip", 2],
      ["bodies/b", 2],
      ["bodies/b/joint", 3],
      ["bodies/lost", 0],
      ["closures/loop", 0],
    ]);
  });
});
