import "@xyflow/react/dist/style.css";

import {
  applyNodeChanges,
  Background,
  BackgroundVariant,
  type Connection,
  ConnectionMode,
  Controls,
  type EdgeChange,
  MiniMap,
  type NodeChange,
  Panel,
  ReactFlow,
  useReactFlow,
} from "@xyflow/react";
import { type DragEvent, useCallback, useEffect, useMemo, useState } from "react";

import type { Point } from "../api/types";
import { add, mount } from "../store/bodies";
import { place } from "../store/edits";
import { insertPart } from "../store/clipboard";
import { now, show, update, useDocument, useStore } from "../store/store";
import { useTheme } from "../store/theme";
import { Block, type BlockNode, frameOf, JOINT } from "./Block";
import { Mount, Tie } from "./links";
import { blocks, links } from "./nodes";
import { useSight, useWholeView } from "./useSight";

const NODE_TYPES = { block: Block };
const EDGE_TYPES = { mount: Mount, tie: Tie };
export const DRAGGED = "application/x-symofros";

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

/** Keeps what is chosen in the store, which alone says it: the diagram shows what stands there. */
function choose(changes: readonly (NodeChange<BlockNode> | EdgeChange)[]): void {
  const chosen = new Set(now().selected);
  for (const change of changes) {
    if (change.type !== "select") continue;
    if (change.selected) chosen.add(change.id);
    else chosen.delete(change.id);
  }
  const before = now().selected;
  if (chosen.size !== before.length || before.some((id) => !chosen.has(id))) update({ selected: [...chosen] });
}

/** Opens the property window of a block or a link. */
export function openProperties(id: string): void {
  const graph = now().document?.graph;
  const path = graph?.nodes.find((node) => node.id === id)?.path ?? graph?.edges.find((edge) => edge.id === id)?.path;
  if (path !== undefined) show({ kind: "properties", path: path.slice(0, 2) });
}

function drop(event: DragEvent, where: Point): void {
  event.preventDefault();
  const word = event.dataTransfer.getData(DRAGGED);
  const item = now().catalogue?.palette.find((each) => each.name === word);
  const part = now().parts.find((each) => `part ${each.name}` === word);
  if (item !== undefined) void add(item, where);
  else if (part !== undefined) void insertPart(part.name, where);
}

function shownPlaces(): Record<string, Point> {
  const { document, places } = now();
  return Object.fromEntries(
    Object.entries(places).filter(([id]) => document?.graph.nodes.some((node) => node.id === id)),
  );
}

/** The diagram. */
export function Canvas() {
  const document = useDocument();
  const places = useStore((state) => state.places);
  const selected = useStore((state) => state.selected);
  const theme = useTheme();
  const flow = useReactFlow();
  const [nodes, setNodes] = useState<BlockNode[]>([]);
  const edges = useMemo(() => links(document.graph, selected), [document.graph, selected]);

  useEffect(() => setNodes((before) => blocks(document, places, selected, before)), [document, places, selected]);
  useWholeView(document.path);
  useSight(document.graph, places);

  const onNodesChange = useCallback((changes: NodeChange<BlockNode>[]) => {
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
    void place({ ...shownPlaces(), ...Object.fromEntries(entries) });
  }, []);

  return (
    <ReactFlow
      id="diagram"
      className="canvas"
      colorMode={theme}
      nodes={nodes}
      edges={edges}
      nodeTypes={NODE_TYPES}
      edgeTypes={EDGE_TYPES}
      onNodesChange={onNodesChange}
      onEdgesChange={choose}
      onConnect={connect}
      onNodeDoubleClick={(_, node) => openProperties(node.id)}
      onEdgeDoubleClick={(_, edge) => openProperties(edge.id)}
      onDragOver={(event) => event.preventDefault()}
      onDrop={(event) => {
        const at = flow.screenToFlowPosition({ x: event.clientX, y: event.clientY });
        drop(event, [Math.round(at.x), Math.round(at.y)]);
      }}
      connectionMode={ConnectionMode.Loose}
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
      {nodes.length === 1 ? (
        <Panel position="top-center" className="quiet">
          Drag a body from the left onto the canvas, or click it there.
        </Panel>
      ) : null}
      {nodes.length > 12 ? <MiniMap pannable zoomable ariaLabel="overview of the diagram" /> : null}
    </ReactFlow>
  );
}
