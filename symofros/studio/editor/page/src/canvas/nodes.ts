/** The document's graph as React Flow's nodes and edges. */

import type { Document, Graph, GraphEdge, GraphNode, Point } from "../api/types";
import { lanes, size } from "../model/geometry";
import { same } from "../model/paths";
import { summary } from "../model/summary";
import { type BlockNode, frameHandle, JOINT } from "./Block";
import type { Link } from "./links";

type Places = Record<string, Point>;

/** Blocks; those that look as before stay the same object, so that they are not drawn again. */
export function blocks(
  document: Document,
  places: Places,
  selected: readonly string[],
  before: readonly BlockNode[],
): BlockNode[] {
  const old = new Map(before.map((node) => [node.id, node]));
  return document.graph.nodes.map((node) => {
    const data = { node, summary: summary(node, document.data) };
    const [x, y] = places[node.id] ?? [0, 0];
    const isSelected = selected.includes(node.id);
    const previous = old.get(node.id);
    const alike =
      previous !== undefined && same(JSON.parse(JSON.stringify(previous.data)), JSON.parse(JSON.stringify(data)));
    if (alike && previous.position.x === x && previous.position.y === y && previous.selected === isSelected)
      return previous;
    const [width, height] = size(node);
    return {
      ...previous,
      id: node.id,
      type: "block" as const,
      position: { x, y },
      data: alike ? previous.data : data,
      selected: isSelected,
      width,
      height,
      ariaLabel: `${node.kind} ${node.title}${node.problems > 0 ? `, ${node.problems} problems` : ""}`,
    };
  });
}

const port = (node: GraphNode | undefined, name: string): string =>
  frameHandle(node?.ports.find((each) => each.name === name));

function joined(
  edge: GraphEdge,
  known: ReadonlyMap<string, GraphNode>,
  lane: number | undefined,
  selected: boolean,
): Link {
  const onJoint = edge.kind === "joint" || edge.kind === "constraint";
  return {
    id: edge.id,
    type: onJoint ? "mount" : "tie",
    source: edge.source,
    target: edge.target,
    sourceHandle: port(known.get(edge.source), edge.source_port),
    targetHandle: onJoint ? JOINT : port(known.get(edge.target), edge.target_port),
    className: edge.kind,
    selected,
    data: { label: edge.label, lane: lane ?? 0 },
    ariaLabel: `${edge.kind} ${edge.label || edge.id}`,
  };
}

/** Links between blocks that are there. */
export function links(graph: Graph, selected: readonly string[]): Link[] {
  const lane = lanes(graph.edges);
  const known = new Map(graph.nodes.map((node) => [node.id, node]));
  return graph.edges
    .filter((edge) => known.has(edge.source) && known.has(edge.target))
    .map((edge) => joined(edge, known, lane.get(edge.id), selected.includes(edge.id)));
}
