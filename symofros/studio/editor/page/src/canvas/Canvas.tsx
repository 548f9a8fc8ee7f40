import { type Connection, ConnectionMode, Panel } from "@xyflow/react";
import { useCallback, useMemo } from "react";

import type { Point } from "../api/types";
import { bentBy } from "../model/bending";
import { blockOf } from "../model/elements";
import { loads, standIns } from "../model/folding";
import { size } from "../model/geometry";
import { add, mount } from "../store/bodies";
import { insertPart } from "../store/clipboard";
import { browseExamples } from "../store/files";
import { MOST_DRAWN } from "../store/requests";
import { now, show, useDocument, useStore } from "../store/store";
import { beginTour } from "../store/tour";
import { Block, type BlockNode, frameOf, JOINT } from "./Block";
import { Board } from "./Board";
import { Mount, Tie } from "./links";
import { blocks, links } from "./nodes";
import { openProperties } from "./open";
import type { Extent } from "./useSight";

const NODE_TYPES = { block: Block };
const EDGE_TYPES = { mount: Mount, tie: Tie };

const bodyOf = (id: string): string => (id === "world" ? "world" : id.slice("bodies/".length));

/** A link from a frame to a joint mounts the joint there; one between two frames asks what shall join them. */
function connect({ source, target, sourceHandle, targetHandle }: Connection): void {
  if (source === target || sourceHandle === null || targetHandle === null) return;
  if (targetHandle === JOINT) void mount(bodyOf(target), { body: bodyOf(source), frame: frameOf(sourceHandle) });
  else if (sourceHandle === JOINT) void mount(bodyOf(source), { body: bodyOf(target), frame: frameOf(targetHandle) });
  else {
    const first = { body: bodyOf(source), frame: frameOf(sourceHandle) };
    show({ kind: "link", first, second: { body: bodyOf(target), frame: frameOf(targetHandle) } });
  }
}

function drop(word: string, where: Point): void {
  const item = now().catalogue?.palette.find((each) => each.name === word);
  const part = now().parts.find((each) => `part ${each.name}` === word);
  if (item !== undefined) void add(item, where);
  else if (part !== undefined) void insertPart(part.name, where);
}

/** Where the block is that an id means: itself, or one end of a link, what has the frame. */
function extent(id: string): Extent | undefined {
  const { document, places } = now();
  const end = document === null ? id : blockOf(document.graph, id);
  const node = document?.graph.nodes.find((each) => each.id === end);
  const place = node === undefined ? undefined : places[node.id];
  return node === undefined || place === undefined ? undefined : { place, size: size(node) };
}

/** A mechanism: bodies on joints. */
export function Canvas() {
  const document = useDocument();
  const places = useStore((state) => state.places);
  const selected = useStore((state) => state.selected);
  const folded = useStore((state) => state.folded);
  const folding = useMemo(
    () => ({ loads: loads(document.graph), folded, standIns: standIns(document.graph, folded) }),
    [document.graph, folded],
  );
  const simulated = useStore((state) => state.jobs.simulate);
  const bent = useMemo(() => bentBy(simulated, document.revision), [simulated, document.revision]);
  // The same links while a block is dragged, so that only its own are drawn again.
  const linked = useMemo(() => links(document.graph, selected, folding.standIns), [document.graph, selected, folding]);
  const edges = useCallback(() => linked, [linked]);
  const drawn = useCallback(
    (before: readonly BlockNode[]) => blocks(document, places, selected, folding, bent, before),
    [document, places, selected, folding, bent],
  );
  return (
    <Board
      blocks={drawn}
      edges={edges}
      nodeTypes={NODE_TYPES}
      edgeTypes={EDGE_TYPES}
      connectionMode={ConnectionMode.Loose}
      connect={connect}
      open={openProperties}
      drop={drop}
      extent={extent}
      hasOverview={12}
    >
      {document.graph.nodes.length === 0 ? (
        <Panel position="top-center" className="quiet">
          {document.undrawn > 0
            ? `${document.undrawn} blocks are more than the ${MOST_DRAWN} that are drawn: the text has them all.`
            : "Nothing can be drawn of this text: its problems say why, and it can be mended beside."}
        </Panel>
      ) : null}
      {document.graph.nodes.length === 1 ? (
        <Panel position="top-center" className="welcome">
          <p className="quiet">Drag a body from the left onto the canvas, or click it there. New here?</p>
          <button type="button" onClick={() => void browseExamples()}>
            Open an example
          </button>
          <button type="button" onClick={beginTour}>
            Take the tour
          </button>
        </Panel>
      ) : null}
    </Board>
  );
}
