/** Where blocks stand when nobody has put them: the tree from left to right, long chains in several rows like text. */

import type { Graph, GraphEdge, GraphNode, Point } from "../api/types";
import { size, WIDTH } from "./geometry";
import { completedPlaces, type Places } from "./places";

const COLUMN = WIDTH + 56;
const GAP = 22;
const ROW_GAP = 44;
// Width over height that a diagram should have, roughly that of a screen.
const ASPECT = 1.7;
const FEWEST_COLUMNS = 4;

interface Tree {
  nodes: Map<string, GraphNode>;
  roots: string[];
  children: Map<string, string[]>;
}

/** Children of each node along joints and conditions. */
function tree(graph: Graph): Tree {
  const nodes = new Map(graph.nodes.map((node) => [node.id, node]));
  const hangs = (edge: GraphEdge): boolean => edge.kind === "joint" || edge.kind === "constraint";
  const children = new Map<string, string[]>();
  const hung = new Set<string>();
  for (const edge of graph.edges.filter((each) => hangs(each) && nodes.has(each.source) && nodes.has(each.target))) {
    const carried = children.get(edge.source) ?? [];
    carried.push(edge.target);
    children.set(edge.source, carried);
    hung.add(edge.target);
  }
  return { nodes, roots: [...nodes.keys()].filter((id) => !hung.has(id)), children };
}

/** All blocks in at most so many columns; what is deeper begins a row of its own below. */
function inColumns({ nodes, roots, children }: Tree, columns: number): Places {
  const places: Places = {};
  const seen = new Set<string>();
  let floor = 0;
  let next: string[] = [];

  // Each parent beside the middle of its children. Returns the middle of the block's height.
  const put = (id: string, depth: number, top: number): number => {
    seen.add(id);
    const height = size(nodes.get(id) as GraphNode)[1];
    const below = (children.get(id) ?? []).filter((child) => !seen.has(child));
    if (depth === columns - 1) next.push(...below);
    const middles =
      depth === columns - 1 ? [] : below.filter((child) => !seen.has(child)).map((child) => put(child, depth + 1, top));
    const first = middles[0];
    const last = middles[middles.length - 1];
    const wanted = first === undefined || last === undefined ? floor + height / 2 : (first + last) / 2;
    const middle = Math.max(wanted, top + height / 2);
    places[id] = [depth * COLUMN, Math.round(middle - height / 2)];
    floor = Math.max(floor, middle + height / 2 + GAP);
    return middle;
  };
  // A loop in a broken document has no root: it is cut where it is met.
  const unseen = (): string[] => [...nodes.keys()].filter((id) => !seen.has(id)).slice(0, 1);
  for (let row = roots; row.length > 0 || seen.size < nodes.size; row = next) {
    next = [];
    const top = floor;
    for (const id of row.length > 0 ? row : unseen()) if (!seen.has(id)) put(id, 0, top);
    floor += ROW_GAP - GAP;
  }
  return places;
}

/** How far the extent of blocks is from the wanted proportions. */
function misfit(places: Places): number {
  const all = Object.values(places);
  const width = Math.max(...all.map(([x]) => x)) + WIDTH;
  const height = Math.max(...all.map(([, y]) => y)) + 80;
  return Math.abs(Math.log(width / height / ASPECT));
}

/** Places of all blocks. */
export function tidy(graph: Graph): Places {
  const whole = tree(graph);
  let best = inColumns(whole, graph.nodes.length + 1);
  const deepest = Math.max(0, ...Object.values(best).map(([x]) => x / COLUMN)) + 1;
  for (let columns = FEWEST_COLUMNS; columns < deepest; columns += 1) {
    const tried = inColumns(whole, columns);
    if (misfit(tried) < misfit(best)) best = tried;
  }
  return best;
}

/**
 * Places of all blocks.
 *
 * @param known Where blocks stand; they stay there.
 * @param remembered Where a block of that name stood once: it goes there again if there is room.
 * @returns Of a block that has neither, a place beside what it hangs on, clear of all others.
 */
export function completed(graph: Graph, known: Places, remembered: Places = {}): Places {
  if (!graph.nodes.some((node) => node.id in known)) return tidy(graph);
  const start = (node: GraphNode, places: Places): Point => {
    const parent = graph.edges.find((edge) => edge.target === node.id && places[edge.source] !== undefined);
    const place = parent === undefined ? undefined : places[parent.source];
    return place === undefined ? [0, 0] : [place[0] + COLUMN, place[1]];
  };
  return completedPlaces(graph.nodes, known, remembered, size, start);
}
