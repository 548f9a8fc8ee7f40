/** Subtrees that are folded into the block that carries them. */

import type { Graph } from "../api/types";

/** The blocks that each block carries directly. */
function carriedBy(graph: Graph): Map<string, string[]> {
  const blocks = new Map<string, string[]>();
  for (const { kind, source, target } of graph.edges)
    if (kind === "joint") blocks.set(source, [...(blocks.get(source) ?? []), target]);
  return blocks;
}

/** All blocks that a block carries; joints that form a cycle are a problem of the document, not of the drawing. */
function subtree(blocks: ReadonlyMap<string, string[]>, id: string): Set<string> {
  const seen = new Set<string>();
  const left = [...(blocks.get(id) ?? [])];
  for (let next = left.pop(); next !== undefined; next = left.pop()) {
    if (seen.has(next) || next === id) continue;
    seen.add(next);
    left.push(...(blocks.get(next) ?? []));
  }
  return seen;
}

/** How many blocks each body carries. */
export function loads(graph: Graph): Map<string, number> {
  const blocks = carriedBy(graph);
  return new Map([...blocks.keys()].filter((id) => id !== "world").map((id) => [id, subtree(blocks, id).size]));
}

/** Hidden block -> the folded block that stands for it: the outermost one. */
export function standIns(graph: Graph, folded: readonly string[]): Map<string, string> {
  const blocks = carriedBy(graph);
  const subtrees = new Map(folded.map((id) => [id, subtree(blocks, id)]));
  const hidden = new Map<string, string>();
  for (const [id, inside] of subtrees) {
    if ([...subtrees.values()].some((other) => other.has(id))) continue;
    for (const block of inside) hidden.set(block, id);
  }
  return hidden;
}

/** What stays folded while a block is seen. */
export function unfoldedFor(graph: Graph, folded: readonly string[], id: string): string[] {
  const blocks = carriedBy(graph);
  return folded.filter((each) => !subtree(blocks, each).has(id));
}
