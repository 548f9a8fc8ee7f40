import { BaseEdge, type Edge, EdgeLabelRenderer, type EdgeProps } from "@xyflow/react";

import type { Point } from "../api/types";
import { rounded } from "../model/routes";

export type SignalEdge = Edge<{ points: Point[]; label: string }, "wire">;

/** The middle of the longest stretch of a way. */
function middle(points: readonly Point[]): Point {
  let best: Point = [0, 0];
  let longest = -1;
  points.slice(1).forEach((b, i) => {
    const a = points[i] as Point;
    const length = Math.abs(a[0] - b[0]) + Math.abs(a[1] - b[1]);
    if (length > longest) [best, longest] = [[(a[0] + b[0]) / 2, (a[1] + b[1]) / 2], length];
  });
  return best;
}

/** The way of a signal; what is wrong with it stands on it. */
export function SignalWire({ id, data, markerEnd }: EdgeProps<SignalEdge>) {
  const points = data?.points ?? [];
  const [x, y] = middle(points);
  return (
    <>
      <BaseEdge id={id} path={rounded(points)} interactionWidth={14} {...(markerEnd ? { markerEnd } : {})} />
      {data?.label ? (
        <EdgeLabelRenderer>
          <div className="wire-label" style={{ transform: `translate(-50%, -50%) translate(${x}px, ${y}px)` }}>
            {data.label}
          </div>
        </EdgeLabelRenderer>
      ) : null}
    </>
  );
}
