/** The document's graph as React Flow's nodes and edges. */

import type { BentBeam } from "../api/jobs";
import type { Document, Graph, GraphEdge, GraphNode, Point } from "../api/types";
import { namedFrames } from "../model/elements";
import { lanes, size } from "../model/geometry";
import { same } from "../model/paths";
import { summary } from "../model/summary";
import { type BlockNode, frameHandle, JOINT } from "./Block";
import type { Link } from "./links";

type Places = Record<string, Point>;

interface Folding {
  /** How many blocks each carries. */
  loads: ReadonlyMap<string, number>;
  folded: readonly string[];
  /** Hidden block -> the one that stands for it. */
  standIns: ReadonlyMap<string, string>;
}

/** Blocks that are not folded away; those that look as before stay the same object, so that they are not drawn again. */
export function blocks(
  document: Document,
  places: Places,
  selected: readonly string[],
  folding: Folding,
  bent: ReadonlyMap<string, BentBeam>,
  before: readonly BlockNode[],
): BlockNode[] {
  const old = new Map(before.map((node) => [node.id, node]));
  const shown = document.graph.nodes.filter(({ id }) => !folding.standIns.has(id));
  return shown.map((node) => {
    const carried = folding.loads.get(node.id) ?? 0;
    const data = {
      node,
      summary: summary(node, document.data),
      carried,
      folded: folding.folded.includes(node.id),
      bent: node.kind === "beam" ? (bent.get(node.title) ?? null) : null,
      marked: namedFrames(node).flatMap(({ id, name }) => (selected.includes(id) ? [name] : [])),
    };
    const [x, y] = places[node.id] ?? [0, 0];
    const isSelected = selected.includes(node.id);
    const previous = old.get(node.id);
    const alike =
      previous !== undefined && same(JSON.parse(JSON.stringify(previous.data)), JSON.parse(JSON.stringify(data)));
    if (alike && previous.position.x === x && previous.position.y === y && previous.selected === isSelected)
      return previous;
    const [width, height] = size(node);
    return {
      // Where no size is stated, a block that changes while React Flow measures it is never measured: no wire is drawn.
      measured: { width, height },
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

/** A link between blocks that are shown; of one that stands for the link's end, it starts at the body itself. */
function joined(
  edge: GraphEdge,
  known: ReadonlyMap<string, GraphNode>,
  lane: number | undefined,
  selected: boolean,
  [source, target]: readonly [string, string],
): Link {
  const onJoint = edge.kind === "joint" || edge.kind === "constraint";
  return {
    id: edge.id,
    type: onJoint ? "mount" : "tie",
    source,
    target,
    sourceHandle: port(source === edge.source ? known.get(source) : undefined, edge.source_port),
    targetHandle: onJoint ? JOINT : port(target === edge.target ? known.get(target) : undefined, edge.target_port),
    className: edge.kind,
    selected,
    data: { label: edge.label, lane: lane ?? 0 },
    ariaLabel: `${edge.kind} ${edge.label || edge.id}`,
  };
}

/** Links between blocks that are there; none within what is folded. */
export function links(graph: Graph, selected: readonly string[], standIns: ReadonlyMap<string, string>): Link[] {
  const lane = lanes(graph.edges);
  const known = new Map(graph.nodes.map((node) => [node.id, node]));
  return graph.edges
    .filter((edge) => known.has(edge.source) && known.has(edge.target))
    .flatMap((edge) => {
      const ends = [standIns.get(edge.source) ?? edge.source, standIns.get(edge.target) ?? edge.target] as const;
      return ends[0] === ends[1] ? [] : [joined(edge, known, lane.get(edge.id), selected.includes(edge.id), ends)];
    });
}
