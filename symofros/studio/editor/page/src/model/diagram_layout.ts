/** Where a diagram's blocks stand when nobody has put them: in layers along the signals, from left to right. */

import type { Diagram, Point, SignalNode, Wire } from "../api/types";
import { BLOCK_WIDTH, blockSize, inlet, outlet } from "./diagram_geometry";
import { completedPlaces, type Places } from "./places";

const COLUMN = BLOCK_WIDTH + 56;
const GAP = 26;
const SWEEPS = 6;
// Its outputs are states: where a loop has one, it is closed from there.
const STATES = "forward_dynamics";

const push = <K, V>(map: Map<K, V[]>, key: K, value: V): void => void map.set(key, [...(map.get(key) ?? []), value]);

/** Whether signals go from one block to another. */
function leads(wires: readonly Wire[], from: string, to: string): boolean {
  const next = new Map<string, string[]>();
  for (const wire of wires) push(next, wire.source, wire.target);
  const seen = new Set([from]);
  const stack = [from];
  for (let id = stack.pop(); id !== undefined; id = stack.pop()) {
    if (id === to) return true;
    for (const other of next.get(id) ?? []) if (!seen.has(other) && seen.add(other)) stack.push(other);
  }
  return false;
}

/** Wires without those that close loops. */
function forward({ nodes, wires }: Diagram): Wire[] {
  const moving = new Set(nodes.filter(({ kind }) => kind === STATES).map(({ id }) => id));
  const rest = wires.filter((wire) => !(moving.has(wire.source) && leads(wires, wire.target, wire.source)));
  const out = new Map<string, Wire[]>();
  for (const wire of rest) push(out, wire.source, wire);
  const state = new Map<string, "open" | "done">();
  const kept: Wire[] = [];
  const visit = (id: string): void => {
    state.set(id, "open");
    for (const wire of out.get(id) ?? []) {
      if (state.get(wire.target) === "open") continue;
      kept.push(wire);
      if (!state.has(wire.target)) visit(wire.target);
    }
    state.set(id, "done");
  };
  const fed = new Set(rest.map(({ target }) => target));
  for (const { id } of [...nodes.filter((each) => !fed.has(each.id)), ...nodes]) if (!state.has(id)) visit(id);
  return kept;
}

/** The layer of each block: behind all that feed it, and as near to what it feeds as that allows. */
function layers(ids: readonly string[], wires: readonly Wire[]): Map<string, number> {
  const layer = new Map(ids.map((id) => [id, 0]));
  const at = (id: string): number => layer.get(id) ?? 0;
  for (let i = 0; i < ids.length; i += 1)
    for (const { source, target } of wires) layer.set(target, Math.max(at(target), at(source) + 1));
  for (let i = 0; i < ids.length; i += 1)
    for (const id of ids) {
      const next = wires.filter(({ source }) => source === id).map(({ target }) => at(target) - 1);
      const isFed = wires.some(({ target }) => target === id);
      if (next.length > 0 && !isFed) layer.set(id, Math.max(at(id), Math.min(...next)));
    }
  return layer;
}

/** Heights of blocks in their columns, each as near as there is room to the ports that it is joined to. */
function heights(columns: SignalNode[][], wires: readonly Wire[]): Map<string, number> {
  const nodes = new Map(columns.flat().map((node) => [node.id, node]));
  const y = new Map<string, number>();
  for (const column of columns) {
    let at = 0;
    for (const node of column) {
      y.set(node.id, at);
      at += blockSize(node)[1] + GAP;
    }
  }
  const wish = (node: SignalNode, side: "before" | "behind" | "both"): number => {
    const wishes = wires.flatMap((wire) => {
      const source = nodes.get(wire.source);
      const target = nodes.get(wire.target);
      if (source === undefined || target === undefined || source === target) return [];
      const shift = outlet(source, wire.source_port)[1] - inlet(target, wire.target_port)[1];
      if (target === node && side !== "behind") return [(y.get(source.id) ?? 0) + shift];
      if (source === node && side !== "before") return [(y.get(target.id) ?? 0) - shift];
      return [];
    });
    return wishes.length === 0 ? (y.get(node.id) ?? 0) : wishes.reduce((a, b) => a + b, 0) / wishes.length;
  };
  const settle = (column: SignalNode[], side: "before" | "behind" | "both"): void => {
    const wanted = new Map(column.map((node) => [node.id, wish(node, side)]));
    column.sort((a, b) => (wanted.get(a.id) ?? 0) - (wanted.get(b.id) ?? 0));
    let floor = -Infinity;
    for (const node of column) {
      const at = Math.max(floor, wanted.get(node.id) ?? 0);
      y.set(node.id, at);
      floor = at + blockSize(node)[1] + GAP;
    }
    // What was pushed down as a whole goes up again by half of it.
    const pushed = column.map(({ id }) => (y.get(id) ?? 0) - (wanted.get(id) ?? 0));
    const lift = pushed.length === 0 ? 0 : pushed.reduce((a, b) => a + b, 0) / pushed.length;
    for (const { id } of column) y.set(id, (y.get(id) ?? 0) - lift);
  };
  for (let sweep = 0; sweep < SWEEPS; sweep += 1) {
    for (const column of columns.slice(1)) settle(column, "before");
    for (const column of [...columns].reverse().slice(1)) settle(column, sweep === SWEEPS - 1 ? "both" : "behind");
  }
  return y;
}

/** Places of all blocks; models and what is joined to nothing stand in a row above the others. */
export function tidyDiagram(diagram: Diagram): Places {
  const joined = new Set(diagram.wires.flatMap(({ source, target }) => [source, target]));
  const nodes = diagram.nodes.filter(({ id }) => joined.has(id));
  const wires = forward({ ...diagram, nodes });
  const layer = layers(
    nodes.map(({ id }) => id),
    wires,
  );
  const columns: SignalNode[][] = [];
  for (const node of nodes) (columns[layer.get(node.id) ?? 0] ??= []).push(node);
  const filled = Array.from(columns, (column) => column ?? []);
  const y = heights(filled, wires);
  const top = Math.min(0, ...y.values());
  const grid = (value: number): number => 4 * Math.round(value / 4);
  const places: Places = {};
  for (const { id } of nodes) places[id] = [(layer.get(id) ?? 0) * COLUMN, grid((y.get(id) ?? 0) - top)];
  const alone = diagram.nodes.filter(({ id }) => !joined.has(id));
  const tallest = Math.max(0, ...alone.map((node) => blockSize(node)[1]));
  alone.forEach(({ id }, i) => {
    places[id] = [i * (BLOCK_WIDTH + 28), grid(-tallest - 2 * GAP)];
  });
  return places;
}

/** Places of all blocks: where they stand, where they stood once, or where there is room behind what feeds them. */
export function completedDiagram(diagram: Diagram, known: Places, remembered: Places = {}): Places {
  if (!diagram.nodes.some(({ id }) => id in known)) return tidyDiagram(diagram);
  const start = ({ id }: SignalNode, places: Places): Point => {
    const wire = diagram.wires.find(({ target, source }) => target === id && places[source] !== undefined);
    const place = wire === undefined ? undefined : places[wire.source];
    return place === undefined ? [0, 0] : [place[0] + COLUMN, place[1]];
  };
  return completedPlaces(diagram.nodes, known, remembered, blockSize, start);
}
