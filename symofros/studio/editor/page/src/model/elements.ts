/** What can be chosen in a document: blocks, links, and the frames of bodies; each by its id. */

import type { Document, Graph, GraphNode, Path } from "../api/types";

type Lines = Document["lines"];

export const frameId = (body: Path, frame: string): string => [...body, "frames", frame].join("/");

/** Whether an id is that of a frame, which is part of a block. */
export const isFrame = (id: string): boolean => /^bodies\/[^/]+\/frames\//.test(id);

/** Frames of a block that have a name, each with its id. */
export const namedFrames = ({ path, ports }: GraphNode): { id: string; name: string }[] =>
  ports.filter(({ kind }) => kind === "frame").map(({ name }) => ({ id: frameId(path, name), name }));

/** Everything that can be chosen. */
export function elementIds({ graph, diagram }: Document): Set<string> {
  const drawn = [...graph.nodes, ...graph.edges, ...(diagram?.nodes ?? []), ...(diagram?.wires ?? [])];
  return new Set([...drawn, ...graph.nodes.flatMap(namedFrames)].map(({ id }) => id));
}

/** The block that an id means: itself, the one at the end of a link, the one that has the frame. */
export function blockOf(graph: Graph, id: string): string {
  const end = graph.edges.find((edge) => edge.id === id)?.target;
  return end ?? graph.nodes.find((node) => namedFrames(node).some((frame) => frame.id === id))?.id ?? id;
}

/** First and last line of what defines an element; of a frame that the text leaves out, those of its body. */
export const linesOf = (lines: Lines, id: string): readonly [number, number] | undefined =>
  lines[id] ?? lines[id.split("/").slice(0, 2).join("/")];

/** The element that a line defines: the innermost one; of several on one line, the outermost. */
export function elementAt(lines: Lines, line: number): string | undefined {
  const around = Object.entries(lines).filter(([, [first, last]]) => first <= line && line <= last);
  const extent = ([id, [first, last]]: (typeof around)[number]): [number, number] => [last - first, id.length];
  around.sort((a, b) => extent(a)[0] - extent(b)[0] || extent(a)[1] - extent(b)[1]);
  return around[0]?.[0];
}
