/** A diagram's blocks and wires as React Flow's nodes and edges. */

import type { Diagram, Point, SignalNode, Wire } from "../api/types";
import { blockSize, inlet, outlet } from "../model/diagram_geometry";
import { same } from "../model/paths";
import { colourOf, type Rate } from "../model/rates";
import { type Box, type End, routes } from "../model/routes";
import { portWords, type SignalBlockNode } from "./SignalBlock";
import type { SignalEdge } from "./SignalWire";

type Places = Record<string, Point>;

function words(node: SignalNode): string {
  const rate = node.period === null ? "" : `, every ${node.period} s`;
  const problems = node.problems > 0 ? `, ${node.problems} problems` : "";
  return `${node.kind.replaceAll("_", " ")} ${node.title}${rate}${problems}`;
}

/** Blocks; those that look as before stay the same object, so that they are not drawn again. */
export function signalBlocks(
  diagram: Diagram,
  all: readonly Rate[],
  places: Places,
  selected: readonly string[],
  before: readonly SignalBlockNode[],
): SignalBlockNode[] {
  const old = new Map(before.map((node) => [node.id, node]));
  return diagram.nodes.map((node) => {
    const data = { node, colour: colourOf(all, node.period) };
    const [x, y] = places[node.id] ?? [0, 0];
    const isSelected = selected.includes(node.id);
    const previous = old.get(node.id);
    const alike =
      previous !== undefined && same(JSON.parse(JSON.stringify(previous.data)), JSON.parse(JSON.stringify(data)));
    if (alike && previous.position.x === x && previous.position.y === y && previous.selected === isSelected)
      return previous;
    const [width, height] = blockSize(node);
    return {
      // Where no size is stated, a block that changes while React Flow measures it is never measured: no wire is drawn.
      measured: { width, height },
      ...previous,
      id: node.id,
      type: "signal" as const,
      position: { x, y },
      data: alike ? previous.data : data,
      selected: isSelected,
      width,
      height,
      ariaLabel: words(node),
    };
  });
}

const shifted = ({ position }: SignalBlockNode, [x, y]: Point): Point => [position.x + x, position.y + y];

/** The ways of all wires between blocks as they stand; while blocks are dragged, only theirs are found anew. */
export function waysOf(diagram: Diagram, nodes: readonly SignalBlockNode[], last: Map<string, Point[]>) {
  const shown = new Map(nodes.map((node) => [node.id, node]));
  const dragged = new Set(nodes.filter((node) => node.dragging === true).map(({ id }) => id));
  const boxes = nodes.map(({ position, data }): Box => {
    const [width, height] = blockSize(data.node);
    return { ...position, width, height };
  });
  const ends = diagram.wires.flatMap((wire): (End & { isMoving: boolean })[] => {
    const [source, target] = [shown.get(wire.source), shown.get(wire.target)];
    if (source === undefined || target === undefined) return [];
    const from = shifted(source, outlet(source.data.node, wire.source_port));
    const to = shifted(target, inlet(target.data.node, wire.target_port));
    const isMoving = dragged.has(wire.source) || dragged.has(wire.target);
    return [{ id: wire.id, signal: `${wire.source} ${wire.source_port}`, from, to, isMoving }];
  });
  if (dragged.size === 0) return routes(ends, boxes);
  const moving = routes(
    ends.filter(({ isMoving }) => isMoving),
    boxes,
  );
  return new Map([...last, ...moving]);
}

/** What goes into a wire, and what it should be, in as few words as stand on it. */
function misfit(wire: Wire, nodes: ReadonlyMap<string, SignalNode>): string {
  const output = nodes.get(wire.source)?.outputs.find(({ name }) => name === wire.source_port);
  const input = nodes.get(wire.target)?.inputs.find(({ name }) => name === wire.target_port);
  const [given, wanted] = [output, input].map((port) => (port === undefined ? "" : portWords(port)));
  return given === "" || wanted === "" || given === wanted ? "does not fit" : `${given} → ${wanted}`;
}

export function signalWires(
  diagram: Diagram,
  all: readonly Rate[],
  ways: ReadonlyMap<string, Point[]>,
  selected: readonly string[],
): SignalEdge[] {
  const nodes = new Map(diagram.nodes.map((node) => [node.id, node]));
  let isLoopNamed = false;
  return diagram.wires.flatMap((wire) => {
    const points = ways.get(wire.id);
    if (points === undefined) return [];
    const isNamed = wire.loop && !isLoopNamed;
    isLoopNamed ||= wire.loop;
    const state = wire.loop ? "loop" : wire.fault === "" ? "" : "wrong";
    return {
      id: wire.id,
      type: "wire" as const,
      source: wire.source,
      target: wire.target,
      sourceHandle: `out ${wire.source_port}`,
      targetHandle: `in ${wire.target_port}`,
      className: `signal rate ${colourOf(all, wire.period)} ${state}`,
      selected: selected.includes(wire.id),
      data: { points, label: wire.fault === "" ? (isNamed ? "algebraic loop" : "") : misfit(wire, nodes) },
      ariaLabel: `wire from ${wire.source.split("/")[1]} ${wire.source_port} to ${wire.target.split("/")[1]} ${wire.target_port}${wire.fault === "" ? "" : `: ${wire.fault}`}${wire.loop ? ", in an algebraic loop" : ""}`,
    };
  });
}
