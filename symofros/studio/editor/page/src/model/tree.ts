/** A document as a tree: bodies on what carries them, each with its joint and its frames; then what links them. */

import type { Document, Graph, GraphNode } from "../api/types";
import { namedFrames } from "./elements";

export interface TreeRow {
  id: string;
  title: string;
  what: string;
  /** The ground is at 0. */
  depth: number;
}

const spoken = (kind: string): string => kind.replaceAll("_", " ");

/** Rows of a body and of all that it carries, without recursion: chains are long. */
function subtree(graph: Graph, root: GraphNode, seen: Set<string>): TreeRow[] {
  const rows: TreeRow[] = [];
  const left: [GraphNode, number][] = [[root, 0]];
  for (let next = left.pop(); next !== undefined; next = left.pop()) {
    const [node, depth] = next;
    if (seen.has(node.id)) continue;
    seen.add(node.id);
    rows.push({ id: node.id, title: node.title, what: spoken(node.kind), depth });
    const inner = depth + 1;
    const joint = graph.edges.find(({ kind, target }) => kind === "joint" && target === node.id);
    if (joint !== undefined) rows.push({ id: joint.id, title: joint.label, what: "joint", depth: inner });
    for (const { id, name } of namedFrames(node)) rows.push({ id, title: name, what: "frame", depth: inner });
    const carried = graph.edges.filter(({ kind, source }) => kind === "joint" && source === node.id);
    for (const { target } of carried.reverse()) {
      const body = graph.nodes.find(({ id }) => id === target);
      if (body !== undefined) left.push([body, inner]);
    }
  }
  return rows;
}

export function treeRows({ graph, diagram }: Document): TreeRow[] {
  if (diagram !== null)
    return diagram.nodes.map(({ id, title, kind }) => ({ id, title, what: spoken(kind), depth: 0 }));
  const seen = new Set<string>();
  const bodies = graph.nodes.filter(({ kind }) => kind !== "nonholonomic");
  return [
    // The ground first; then bodies that hang on nothing.
    ...bodies.filter(({ kind }) => kind === "base").flatMap((node) => subtree(graph, node, seen)),
    ...bodies.flatMap((node) => (seen.has(node.id) ? [] : subtree(graph, node, seen))),
    ...graph.edges
      .filter(({ kind }) => ["closure", "connection", "contact"].includes(kind))
      .map(({ id, label, kind }) => ({ id, title: label, what: kind, depth: 0 })),
    ...graph.nodes
      .filter(({ kind }) => kind === "nonholonomic")
      .map(({ id, title }) => ({ id, title, what: "condition", depth: 0 })),
  ];
}
