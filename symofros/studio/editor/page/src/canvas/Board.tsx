import "@xyflow/react/dist/style.css";

import {
  applyNodeChanges,
  Background,
  BackgroundVariant,
  type Connection,
  type ConnectionMode,
  Controls,
  type Edge,
  type EdgeChange,
  type EdgeTypes,
  MiniMap,
  type Node,
  type NodeChange,
  type NodeTypes,
  ReactFlow,
  useReactFlow,
} from "@xyflow/react";
import { type ReactNode, useCallback, useEffect, useMemo, useState } from "react";

import type { Point } from "../api/types";
import { isFrame } from "../model/elements";
import { moveBlocks } from "../store/edits";
import { now, update, useDocument, useStore } from "../store/store";
import { useTheme } from "../store/theme";
import { type Extent, useSight, useWholeView } from "./useSight";

/** What a palette's entry carries while it is dragged. */
export const DRAGGED = "application/x-symofros";

/** Keeps what is chosen in the store, which alone says it: the diagram shows what stands there. */
function choose(changes: readonly (NodeChange | EdgeChange)[]): void {
  // What is chosen here takes the place of frames, of which the board knows nothing.
  const isNew = changes.some((change) => change.type === "select" && change.selected);
  const chosen = new Set(now().selected.filter((id) => !isNew || !isFrame(id)));
  for (const change of changes) {
    if (change.type !== "select") continue;
    if (change.selected) chosen.add(change.id);
    else chosen.delete(change.id);
  }
  const before = now().selected;
  if (chosen.size !== before.length || before.some((id) => !chosen.has(id))) update({ selected: [...chosen] });
}

type Pressed = { preventDefault(): void; clientX: number; clientY: number };

/** Opens the menu of a block, a link, or the canvas; what it is about is chosen first. */
function openMenu(
  event: Pressed,
  id: string | null,
  toCanvas: (at: { x: number; y: number }) => { x: number; y: number },
): void {
  event.preventDefault();
  const { x, y } = toCanvas({ x: event.clientX, y: event.clientY });
  const { selected } = now();
  update({
    menu: { id, at: [event.clientX, event.clientY], where: [Math.round(x), Math.round(y)] },
    selected: id === null || selected.includes(id) ? selected : [id],
  });
}

function shownPlaces(): Record<string, Point> {
  const { document, places } = now();
  const ids = new Set([...(document?.graph.nodes ?? []), ...(document?.diagram?.nodes ?? [])].map(({ id }) => id));
  return Object.fromEntries(Object.entries(places).filter(([id]) => ids.has(id)));
}

interface Props<N extends Node> {
  /** The blocks; those that look as before stay the same object, so that they are not drawn again. */
  blocks(before: readonly N[]): N[];
  /** Wires between blocks, where these stand now. */
  edges(nodes: readonly N[]): Edge[];
  nodeTypes: NodeTypes;
  edgeTypes: EdgeTypes;
  connectionMode: ConnectionMode;
  connect(connection: Connection): void;
  open(id: string): void;
  /** Something was dropped from the palette. */
  drop(word: string, where: Point): void;
  extent(id: string): Extent | undefined;
  /** Of how many blocks on there is an overview. */
  hasOverview: number;
  children?: ReactNode;
}

/** What all diagrams have: blocks that are moved, chosen, joined, looked at. */
export function Board<N extends Node>({
  blocks,
  edges,
  nodeTypes,
  edgeTypes,
  connectionMode,
  connect,
  open,
  drop,
  extent,
  hasOverview,
  children,
}: Props<N>) {
  const { path } = useDocument();
  const places = useStore((state) => state.places);
  const theme = useTheme();
  const flow = useReactFlow();
  const [nodes, setNodes] = useState<N[]>([]);

  useEffect(() => setNodes(blocks), [blocks]);
  useWholeView(path);
  useSight(extent, places);

  const onNodesChange = useCallback((changes: NodeChange<N>[]) => {
    choose(changes);
    const others = changes.filter((change) => change.type !== "select");
    if (others.length > 0) setNodes((before) => applyNodeChanges(others, before));
    const moved = changes.filter(
      (change) => change.type === "position" && change.dragging !== true && change.position !== undefined,
    );
    if (moved.length === 0) return;
    const entries = moved.map((change) => {
      const at = change.type === "position" ? change.position : undefined;
      return ["id" in change ? change.id : "", [Math.round(at?.x ?? 0), Math.round(at?.y ?? 0)] as const] as const;
    });
    // The others are kept where they are shown, too.
    void moveBlocks({ ...shownPlaces(), ...Object.fromEntries(entries) });
  }, []);
  const drawn = useMemo(() => edges(nodes), [edges, nodes]);

  return (
    <ReactFlow
      id="diagram"
      className="canvas"
      colorMode={theme}
      nodes={nodes}
      edges={drawn}
      nodeTypes={nodeTypes}
      edgeTypes={edgeTypes}
      onNodesChange={onNodesChange}
      onEdgesChange={choose}
      onNodeContextMenu={(event, node) => openMenu(event, node.id, flow.screenToFlowPosition)}
      onEdgeContextMenu={(event, edge) => openMenu(event, edge.id, flow.screenToFlowPosition)}
      onPaneContextMenu={(event) => openMenu(event, null, flow.screenToFlowPosition)}
      onPaneClick={() => update({ selected: [] })}
      onConnect={connect}
      onNodeDoubleClick={(_, node) => open(node.id)}
      onEdgeDoubleClick={(_, edge) => open(edge.id)}
      onDragOver={(event) => event.preventDefault()}
      onDrop={(event) => {
        event.preventDefault();
        const at = flow.screenToFlowPosition({ x: event.clientX, y: event.clientY });
        drop(event.dataTransfer.getData(DRAGGED), [Math.round(at.x), Math.round(at.y)]);
      }}
      connectionMode={connectionMode}
      connectionRadius={28}
      snapToGrid
      snapGrid={[4, 4]}
      minZoom={0.1}
      maxZoom={2.5}
      zoomOnDoubleClick={false}
      deleteKeyCode={null}
      selectionKeyCode="Shift"
      multiSelectionKeyCode={["Control", "Meta"]}
      elevateNodesOnSelect={false}
      proOptions={{ hideAttribution: true }}
    >
      <Background variant={BackgroundVariant.Dots} gap={20} size={1} />
      <Controls showInteractive={false} position="bottom-left" />
      {children}
      {nodes.length > hasOverview ? <MiniMap pannable zoomable ariaLabel="overview of the diagram" /> : null}
    </ReactFlow>
  );
}
