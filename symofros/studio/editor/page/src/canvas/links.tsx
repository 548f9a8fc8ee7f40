import { BaseEdge, type Edge, EdgeLabelRenderer, type EdgeProps } from "@xyflow/react";

import { mountPath, tieMiddle, tiePath } from "../model/geometry";

export type Link = Edge<{ label: string; lane: number }, "mount" | "tie">;

/** A joint in a frame of its parent, or a condition on a frame. */
export function Mount({ id, sourceX, sourceY, targetX, targetY }: EdgeProps<Link>) {
  return <BaseEdge id={id} path={mountPath([sourceX, sourceY], [targetX, targetY])} interactionWidth={16} />;
}

/** A closure or a spring between frames: with its name. */
export function Tie({ id, sourceX, sourceY, targetX, targetY, data }: EdgeProps<Link>) {
  const ends = [[sourceX, sourceY], [targetX, targetY], data?.lane ?? 0] as const;
  const [x, y] = tieMiddle(...ends);
  return (
    <>
      <BaseEdge id={id} path={tiePath(...ends)} interactionWidth={16} />
      <EdgeLabelRenderer>
        <div className="tie-label" style={{ transform: `translate(-50%, -50%) translate(${x}px, ${y}px)` }}>
          {data?.label}
        </div>
      </EdgeLabelRenderer>
    </>
  );
}
