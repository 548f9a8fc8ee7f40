import { useReactFlow, useStoreApi } from "@xyflow/react";
import { useEffect, useRef } from "react";

import type { Graph, GraphNode, Point } from "../api/types";
import { lanes, size } from "../model/geometry";
import { now, useStore } from "../store/store";

const MARGIN = 20;
const NOTHING: Graph = { nodes: [], edges: [] };

/** The block that an id means: itself, or one end of a link. */
function target(graph: Graph, id: string): GraphNode | undefined {
  const end = graph.edges.find((edge) => edge.id === id)?.target ?? id;
  return graph.nodes.find((node) => node.id === end);
}

const isCalm = window.matchMedia("(prefers-reduced-motion: reduce)");

/** How long the diagram takes to move [ms]. */
export const pace = (): number => (isCalm.matches ? 0 : 200);

/** Options of a view of the whole diagram; ties swing out on the right. */
export function whole(graph: Graph) {
  const right = lanes(graph.edges).size > 0 ? "96px" : "40px";
  return { padding: { top: "32px", bottom: "32px", left: "40px", right }, maxZoom: 1 } as const;
}

/** Shows the whole diagram when a file is opened, and when results take some of its room. */
export function useWholeView(path: string): void {
  const flow = useReactFlow();
  const hasResults = useStore((state) => state.bottom !== null);
  useEffect(() => {
    const frame = requestAnimationFrame(() => {
      // An empty model grows to the right.
      if (flow.getNodes().length > 1) void flow.fitView(whole(now().document?.graph ?? NOTHING));
      else void flow.setViewport({ x: 60, y: 120, zoom: 1 });
    });
    return () => cancelAnimationFrame(frame);
  }, [flow, path, hasResults]);
}

/** Moves the diagram, if it must, so that what was asked for is seen. */
export function useSight(graph: Graph, places: Record<string, Point>): void {
  const sight = useStore((state) => state.sight);
  const flow = useReactFlow();
  const store = useStoreApi();
  const seen = useRef<object | null>(null);
  useEffect(() => {
    const node = sight === null ? undefined : target(graph, sight.id);
    const place = node === undefined ? undefined : places[node.id];
    if (sight === seen.current || node === undefined || place === undefined) return;
    seen.current = sight;
    const { x, y, zoom } = flow.getViewport();
    const { width, height } = store.getState();
    const [w, h] = size(node);
    const isInside = (from: number, extent: number, room: number): boolean =>
      from >= MARGIN && from + extent <= room - MARGIN;
    if (
      zoom >= 0.5 &&
      isInside(place[0] * zoom + x, w * zoom, width) &&
      isInside(place[1] * zoom + y, h * zoom, height)
    )
      return;
    void flow.setCenter(place[0] + w / 2, place[1] + h / 2, {
      zoom: Math.min(1, Math.max(0.7, zoom)),
      duration: pace(),
    });
  }, [sight, graph, places, flow, store]);
}
