import { BaseEdge, EdgeLabelRenderer, type EdgeProps, getBezierPath } from "@xyflow/react";

import { mountPath } from "../model/geometry";

/** A joint in a frame of its parent. */
export function Mount({ id, sourceX, sourceY, targetX, targetY }: EdgeProps) {
  return <BaseEdge id={id} path={mountPath([sourceX, sourceY], [targetX, targetY])} interactionWidth={16} />;
}

/** A closure, a spring between frames, or a condition: dashed, with its name. */
export function Tie({ id, sourceX, sourceY, targetX, targetY, sourcePosition, targetPosition, data }: EdgeProps) {
  const [path, x, y] = getBezierPath({ sourceX, sourceY, targetX, targetY, sourcePosition, targetPosition, curvature: 0.4 });
  const label = typeof data?.["label"] === "string" ? data["label"] : "";
  return (
    <>
      <BaseEdge id={id} path={path} interactionWidth={16} />
      {label === "" ? null : (
        <EdgeLabelRenderer>
          <div className={`tie-label ${String(data?.["kind"])}`} style={{ transform: `translate(-50%, -50%) translate(${x}px, ${y}px)` }}>
            {label}
          </div>
        </EdgeLabelRenderer>
      )}
    </>
  );
}
