/** Sizes of blocks and places of their ports: one source for the canvas, the layout and the picture. */

import type { GraphEdge, GraphNode, Point, Port } from "../api/types";

export const WIDTH = 196;
export const HEADER = 26;
const ROW = 20;
const PAD = 6;
const SMALL_WIDTH = 132;

/** Ports that others can be put on: the body's own frame, then those with names. */
export function frames(node: GraphNode): Port[] {
  return node.ports.filter((port) => port.kind !== "root");
}

export function hasJoint(node: GraphNode): boolean {
  return node.ports.some((port) => port.kind === "root");
}

export function size(node: GraphNode): Point {
  if (node.kind === "nonholonomic") return [SMALL_WIDTH, HEADER + ROW];
  return [WIDTH, HEADER + 2 * PAD + ROW * Math.max(hasJoint(node) ? 2 : 1, frames(node).length)];
}

/** Height of a port's middle below the block's top. */
export function portHeight(node: GraphNode, port: string): number {
  if (node.kind === "nonholonomic") return (HEADER + ROW) / 2;
  const row = frames(node).findIndex((frame) => frame.name === port);
  return HEADER + PAD + ROW * (Math.max(row, 0) + 0.5);
}

export const jointHeight = HEADER + PAD + ROW / 2;

/** The line from a frame to a joint: a curve forwards, around the blocks' edges backwards. */
export function mountPath([x0, y0]: Point, [x1, y1]: Point): string {
  if (x1 >= x0 + 16) {
    const reach = Math.max(24, (x1 - x0) / 2);
    return `M${x0},${y0}C${x0 + reach},${y0} ${x1 - reach},${y1} ${x1},${y1}`;
  }
  const lane = y1 - HEADER - PAD - ROW / 2 - 14;
  return `M${x0},${y0}H${x0 + 18}V${lane}H${x1 - 18}V${y1}H${x1}`;
}

/** How far a tie swings out: further for the later ones, so that they do not lie on each other. */
const reachOf = ([, y0]: Point, [, y1]: Point, lane: number): number => 34 + 0.16 * Math.abs(y1 - y0) + 12 * lane;

/** The line from a frame to a frame, both on the right of their blocks. */
export function tiePath(from: Point, to: Point, lane: number): string {
  const reach = reachOf(from, to, lane);
  return `M${from[0]},${from[1]}C${from[0] + reach},${from[1]} ${to[0] + reach},${to[1]} ${to[0]},${to[1]}`;
}

/** The middle of that line, for its name. */
export function tieMiddle(from: Point, to: Point, lane: number): Point {
  return [(from[0] + to[0]) / 2 + 0.75 * reachOf(from, to, lane), (from[1] + to[1]) / 2];
}

/** Which of the ties each edge is. */
export function lanes(edges: readonly GraphEdge[]): Map<string, number> {
  const ties = edges.filter((edge) => ["closure", "connection", "contact"].includes(edge.kind));
  return new Map(ties.map((edge, i) => [edge.id, i]));
}

/** Where an edge starts and ends, relative to its blocks; joints are on the left, frames on the right. */
export function ends(edge: GraphEdge, source: GraphNode, target: GraphNode): { from: Point; to: Point } {
  const right = (node: GraphNode): number => size(node)[0];
  const from: Point = [right(source), portHeight(source, edge.source_port)];
  if (edge.kind === "joint") return { from, to: [0, jointHeight] };
  if (edge.kind === "constraint") return { from, to: [0, portHeight(target, edge.target_port)] };
  return { from, to: [right(target), portHeight(target, edge.target_port)] };
}
