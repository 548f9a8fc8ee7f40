import { describe, expect, it } from "vitest";

import type { Diagram, Point, SignalNode, Wire } from "../src/api/types";
import { meant, written } from "../src/forms/values";
import { blockSize, inlet, outlet } from "../src/model/diagram_geometry";
import { completedDiagram, tidyDiagram } from "../src/model/diagram_layout";
import { equal } from "../src/model/plot";
import { colourOf, rates } from "../src/model/rates";
import { type Box, type End, routes } from "../src/model/routes";

const port = (name: string) => ({ name, shape: [], unit: "", required: true, fault: "" });

const block = (title: string, inputs: string[], outputs: string[], more: Partial<SignalNode> = {}): SignalNode => ({
  id: `blocks/${title}`,
  kind: "gain",
  group: "generic",
  title,
  note: "",
  path: ["blocks", title],
  period: null,
  inputs: inputs.map(port),
  outputs: outputs.map(port),
  problems: 0,
  ...more,
});

const wire = (from: string, to: string): Wire => {
  const [source, output] = from.split(".");
  const [target, input] = to.split(".");
  return {
    id: `blocks/${target}/inputs/${input}`,
    source: `blocks/${source}`,
    source_port: output ?? "",
    target: `blocks/${target}`,
    target_port: input ?? "",
    path: ["blocks", target ?? "", "inputs", input ?? ""],
    period: null,
    fault: "",
    loop: false,
  };
};

/** A controller, its plant, what measures it: closed by the plant's state. */
const CLOSED: Diagram = {
  nodes: [
    block("plant", ["u"], ["q", "v"], { kind: "forward_dynamics" }),
    block("path", [], ["p"]),
    block("law", ["p", "q"], ["u"], { period: 0.001 }),
    block("seen", ["u"], ["y"], { period: 0.01 }),
    { ...block("arm", [], []), id: "models/arm", kind: "model", path: ["models", "arm"], note: "arm.yaml" },
  ],
  wires: [wire("path.p", "law.p"), wire("seen.y", "law.q"), wire("law.u", "plant.u"), wire("plant.q", "seen.u")],
  models: {},
  moving: [],
};

function boxes(diagram: Diagram, places: Record<string, Point>): Box[] {
  return diagram.nodes.map((node) => {
    const [x, y] = places[node.id] ?? [NaN, NaN];
    const [width, height] = blockSize(node);
    return { x, y, width, height };
  });
}

function ends(diagram: Diagram, places: Record<string, Point>): End[] {
  const nodes = new Map(diagram.nodes.map((node) => [node.id, node]));
  return diagram.wires.map((each) => {
    const at = (id: string, [x, y]: Point): Point => [(places[id]?.[0] ?? 0) + x, (places[id]?.[1] ?? 0) + y];
    const from = at(each.source, outlet(nodes.get(each.source) as SignalNode, each.source_port));
    const to = at(each.target, inlet(nodes.get(each.target) as SignalNode, each.target_port));
    return { id: each.id, signal: `${each.source} ${each.source_port}`, from, to };
  });
}

describe("a diagram that nobody has arranged", () => {
  const places = tidyDiagram(CLOSED);

  it("goes from left to right, and is closed behind the plant", () => {
    const x = (name: string): number => places[`blocks/${name}`]?.[0] ?? NaN;
    expect(x("path")).toBeLessThan(x("law"));
    expect(x("seen")).toBeLessThan(x("law"));
    expect(x("law")).toBeLessThan(x("plant"));
  });

  it("has no block upon another", () => {
    const all = boxes(CLOSED, places);
    all.forEach((a, i) =>
      all.slice(i + 1).forEach((b) => {
        const apart = a.x + a.width <= b.x || b.x + b.width <= a.x || a.y + a.height <= b.y || b.y + b.height <= a.y;
        expect(apart).toBe(true);
      }),
    );
  });

  it("keeps what somebody has put", () => {
    const put = { ...places, "blocks/law": [777, 333] as const };
    expect(completedDiagram(CLOSED, put)).toEqual(put);
  });
});

describe("ways of wires", () => {
  const places = tidyDiagram(CLOSED);
  const all = boxes(CLOSED, places);
  const ways = routes(ends(CLOSED, places), all);

  it("go from port to port along the grid", () => {
    for (const end of ends(CLOSED, places)) {
      const points = ways.get(end.id) ?? [];
      expect([points[0], points.at(-1)]).toEqual([end.from, end.to]);
      points.slice(1).forEach((b, i) => {
        const a = points[i] as Point;
        expect(a[0] === b[0] || a[1] === b[1]).toBe(true);
      });
    }
  });

  it("go through no block", () => {
    for (const points of ways.values())
      points.slice(1).forEach((b, i) => {
        const a = points[i] as Point;
        const middle: Point = [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
        const inside = all.some(
          ({ x, y, width, height }) =>
            middle[0] > x && middle[0] < x + width && middle[1] > y && middle[1] < y + height,
        );
        expect(inside).toBe(false);
      });
  });
});

describe("sample times", () => {
  it("have a colour each, the fastest first; continuous blocks have none", () => {
    const found = rates(CLOSED);
    expect(found.map(({ words }) => words)).toEqual(["1 ms", "10 ms"]);
    expect(colourOf(found, 0.001)).not.toBe(colourOf(found, 0.01));
    expect(colourOf(found, null)).toBe("continuous");
  });
});

describe("values as one writes them", () => {
  it.each([
    ["4", 4],
    ["[6.0e1, 25, -.5]", [60, 25, -0.5]],
    [
      "[[1, 0], [0, 1e-3]]",
      [
        [1, 0],
        [0, 1e-3],
      ],
    ],
    ["[q1, arm.q2]", ["q1", "arm.q2"]],
    ["actuated", "actuated"],
    ["true", true],
    ["", undefined],
  ])("%s", (text, value) => {
    expect(meant(text)).toEqual({ value });
  });

  it("are no values while they are typed", () => {
    expect(meant("[1, 2")).toBeUndefined();
  });

  it("come out as they went in", () => {
    expect(written([600, [1, "a"]])).toBe("[600, [1, a]]");
  });
});

describe("a plot of a plane", () => {
  it("has one scale along both sides", () => {
    const box = { x: 0, y: 0, width: 400, height: 200 };
    const [xs, ys] = equal([0, 1], [0, 1], box);
    expect((xs[1] - xs[0]) / box.width).toBeCloseTo((ys[1] - ys[0]) / box.height);
    expect(ys[0]).toBeLessThan(0);
    expect(ys[1]).toBeGreaterThan(1);
  });
});
