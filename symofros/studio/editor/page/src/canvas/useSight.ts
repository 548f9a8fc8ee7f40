import { type Rect, useReactFlow, useStoreApi } from "@xyflow/react";
import { useEffect, useRef } from "react";

import type { Point } from "../api/types";
import { lanes } from "../model/geometry";
import { now, useStore } from "../store/store";

const MARGIN = 20;
// Beside the whole diagram, for ties that swing out [px].
const LANE = 68;
// The least zoom at which words are read.
const LEGIBLE = 0.5;
/** Where a block stands, and how large it is. */
export interface Extent {
  place: Point;
  size: Point;
}

const isCalm = window.matchMedia("(prefers-reduced-motion: reduce)");

/** How long the diagram takes to move [ms]. */
export const pace = (): number => (isCalm.matches ? 0 : 200);

/** Options of a view of the whole diagram; ties swing out on the right. */
export function whole() {
  const right = lanes(now().document?.graph.edges ?? []).size > 0 ? "96px" : "40px";
  return { padding: { top: "32px", bottom: "32px", left: "40px", right }, maxZoom: 1 } as const;
}

/** Shows the whole diagram when a file is opened, and when results take some of its room. */
export function useWholeView(path: string): void {
  const flow = useReactFlow();
  const hasResults = useStore((state) => state.bottom !== null);
  useEffect(() => {
    const frame = requestAnimationFrame(() => {
      // An empty model grows to the right.
      if (flow.getNodes().length > 1) void flow.fitView(whole());
      else void flow.setViewport({ x: 60, y: 120, zoom: 1 });
    });
    return () => cancelAnimationFrame(frame);
  }, [flow, path, hasResults]);
}

/** Whether all blocks can be read side by side in a room of this size. */
const fits = (all: Rect, width: number, height: number): boolean =>
  all.width * LEGIBLE + 2 * LANE <= width && all.height * LEGIBLE + 2 * LANE <= height;

/** Moves the diagram, if it must, so that what was asked for is seen. */
export function useSight(extent: (id: string) => Extent | undefined, places: Record<string, Point>): void {
  const sight = useStore((state) => state.sight);
  const flow = useReactFlow();
  const store = useStoreApi();
  const seen = useRef<object | null>(null);
  useEffect(() => {
    const asked = sight === null ? undefined : extent(sight.id);
    if (sight === seen.current || asked === undefined) return;
    const { place } = asked;
    seen.current = sight;
    const { x, y, zoom } = flow.getViewport();
    const { width, height } = store.getState();
    const [w, h] = asked.size;
    const isInside = (from: number, extent: number, room: number): boolean =>
      from >= MARGIN && from + extent <= room - MARGIN;
    if (
      zoom >= LEGIBLE &&
      isInside(place[0] * zoom + x, w * zoom, width) &&
      isInside(place[1] * zoom + y, h * zoom, height)
    )
      return;
    if (fits(flow.getNodesBounds(flow.getNodes()), width, height)) {
      void flow.fitView({ ...whole(), duration: pace() });
      return;
    }
    void flow.setCenter(place[0] + w / 2, place[1] + h / 2, {
      zoom: Math.min(1, Math.max(0.7, zoom)),
      duration: pace(),
    });
  }, [sight, extent, places, flow, store]);
}
