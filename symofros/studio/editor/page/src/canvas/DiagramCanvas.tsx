import { type Connection, ConnectionMode, Panel } from "@xyflow/react";
import { useCallback, useMemo, useRef } from "react";

import type { Diagram, Point } from "../api/types";
import { blockSize } from "../model/diagram_geometry";
import { type Rate, rates } from "../model/rates";
import { addBlock, link, look } from "../store/diagram";
import { remove } from "../store/elements";
import { MOST_DRAWN } from "../store/requests";
import { now, useDocument, useStore } from "../store/store";
import { Board } from "./Board";
import { goInto } from "./open";
import { SignalBlock, type SignalBlockNode } from "./SignalBlock";
import { signalBlocks, signalWires, waysOf } from "./signals";
import { SignalWire } from "./SignalWire";
import type { Extent } from "./useSight";

const NODE_TYPES = { signal: SignalBlock };
const EDGE_TYPES = { wire: SignalWire };
const NOTHING: Diagram = { nodes: [], wires: [], models: {}, moving: [] };

const portOf = (handle: string): string => handle.slice(handle.indexOf(" ") + 1);

function connect({ source, target, sourceHandle, targetHandle }: Connection): void {
  if (sourceHandle === null || targetHandle === null) return;
  void link(source, portOf(sourceHandle), target, portOf(targetHandle));
}

function drop(word: string, where: Point): void {
  const item = now().catalogue?.diagram.palette.find((each) => each.kind === word);
  if (item !== undefined) void addBlock(item, where);
}

/** Where the block is that an id means: itself, or the end of a wire. */
function extent(id: string): Extent | undefined {
  const { document, places } = now();
  const end = document?.diagram?.wires.find((wire) => wire.id === id)?.target ?? id;
  const node = document?.diagram?.nodes.find((each) => each.id === end);
  const place = node === undefined ? undefined : places[node.id];
  return node === undefined || place === undefined ? undefined : { place, size: blockSize(node) };
}

/** Which colour means which sample time. */
function Legend({ all, diagram }: { all: readonly Rate[]; diagram: Diagram }) {
  const isContinuous = diagram.nodes.some(({ kind, period }) => kind !== "model" && period === null);
  if (all.length === 0) return null;
  return (
    <Panel position="top-right">
      <ul className="rates" aria-label="Sample times">
        {all.map(({ colour, words }) => (
          <li key={words} className={`rate ${colour}`}>
            <i /> every {words}
          </li>
        ))}
        {isContinuous ? (
          <li className="rate continuous">
            <i /> continuous
          </li>
        ) : null}
      </ul>
    </Panel>
  );
}

/** What can be done with the wire that is chosen. */
function OfWire({ diagram, selected }: { diagram: Diagram; selected: readonly string[] }) {
  const wire = selected.length === 1 ? diagram.wires.find(({ id }) => id === selected[0]) : undefined;
  if (wire === undefined) return null;
  return (
    <Panel position="top-center" className="of-wire">
      <span>
        {wire.source.split("/")[1]}.{wire.source_port}
      </span>
      <button type="button" className="small" onClick={() => void look(wire.source, wire.source_port)}>
        Add a scope
      </button>
      <button type="button" className="small" onClick={() => void remove([wire.id])}>
        Remove
      </button>
    </Panel>
  );
}

/** A diagram: blocks, and signals between them. */
export function DiagramCanvas() {
  const { diagram: drawing, undrawn } = useDocument();
  const diagram = drawing ?? NOTHING;
  const places = useStore((state) => state.places);
  const selected = useStore((state) => state.selected);
  const all = useMemo(() => rates(diagram), [diagram]);
  const last = useRef(new Map<string, Point[]>());
  const drawn = useCallback(
    (before: readonly SignalBlockNode[]) => signalBlocks(diagram, all, places, selected, before),
    [diagram, all, places, selected],
  );
  const edges = useCallback(
    (nodes: readonly SignalBlockNode[]) => {
      last.current = waysOf(diagram, nodes, last.current);
      return signalWires(diagram, all, last.current, selected);
    },
    [diagram, all, selected],
  );
  return (
    <Board
      blocks={drawn}
      edges={edges}
      nodeTypes={NODE_TYPES}
      edgeTypes={EDGE_TYPES}
      connectionMode={ConnectionMode.Strict}
      connect={connect}
      open={goInto}
      drop={drop}
      extent={extent}
      hasOverview={40}
    >
      <Legend all={all} diagram={diagram} />
      <OfWire diagram={diagram} selected={selected} />
      {diagram.nodes.length === 0 ? (
        <Panel position="top-center" className="quiet">
          {undrawn > 0
            ? `${undrawn} blocks are more than the ${MOST_DRAWN} that are drawn: the text has them all.`
            : "Drag a model and blocks from the left onto the canvas, or click them there; then draw from output to input."}
        </Panel>
      ) : null}
    </Board>
  );
}
