import { Handle, type Node, type NodeProps, Position } from "@xyflow/react";
import { memo } from "react";

import type { GraphNode, Port } from "../api/types";
import { frames, hasJoint, jointHeight, portHeight, size } from "../model/geometry";
import type { Summary } from "../model/summary";
import { Glyph } from "../shell/Glyph";

export type BlockNode = Node<{ node: GraphNode; summary: Summary }, "block">;

/** Ids of handles; a body's own frame has no name. */
export const JOINT = "joint";
export const frameHandle = (port: Port | undefined): string => `frame ${port?.kind === "frame" ? port.name : ""}`;
export const frameOf = (handle: string): string => handle.slice("frame ".length);

/** A body: its joint on the left, the frames that others can be put on at the right. */
function Body({ data }: NodeProps<BlockNode>) {
  const { node, summary } = data;
  const [width, height] = size(node);
  return (
    <div className={`block ${node.kind}${node.problems > 0 ? " wrong" : ""}`} style={{ width, height }}>
      <div className="block-head">
        <Glyph name={node.kind} size={14} />
        <span className="block-title">{node.title}</span>
        {node.problems > 0 ? <span className="block-problems">{node.problems}</span> : null}
        <span className="block-note">{summary.note}</span>
      </div>
      {summary.joint === null ? null : (
        <div className="block-joint">
          <Glyph name={summary.joint.kind} />
          <span className="block-joint-name">{summary.joint.name}</span>
          <span className="block-joint-kind">{summary.joint.kind}</span>
          {summary.joint.actuated ? (
            <span className="block-mark" title="driven by a motor or an effort">
              <Glyph name="motor" size={12} />
            </span>
          ) : null}
          {summary.joint.sprung ? (
            <span className="block-mark" title="spring, damper, stop or friction">
              <Glyph name="spring" size={12} />
            </span>
          ) : null}
        </div>
      )}
      {hasJoint(node) ? (
        <Handle
          id={JOINT}
          type="target"
          position={Position.Left}
          className="port joint"
          style={{ top: jointHeight }}
          role="img"
          aria-label={`joint of ${node.title}`}
        />
      ) : null}
      {frames(node).map((frame) => (
        <div key={frame.name} className="block-frame" style={{ top: portHeight(node, frame.name) }}>
          <span className={frame.kind === "origin" ? "quiet" : ""}>
            {frame.kind === "origin" ? "origin" : frame.name}
          </span>
          <Handle
            id={frameHandle(frame)}
            type="source"
            position={Position.Right}
            className="port frame"
            role="img"
            aria-label={`frame ${frame.kind === "origin" ? "origin" : frame.name} of ${node.title}`}
          />
        </div>
      ))}
    </div>
  );
}

/** A condition on speeds. */
function Condition({ data }: NodeProps<BlockNode>) {
  const { node, summary } = data;
  const [width, height] = size(node);
  return (
    <div className={`block ${node.kind}${node.problems > 0 ? " wrong" : ""}`} style={{ width, height }}>
      <div className="block-head">
        <Glyph name={node.kind} size={14} />
        <span className="block-title">{node.title}</span>
        {node.problems > 0 ? <span className="block-problems">{node.problems}</span> : null}
      </div>
      <div className="block-kind">{summary.note}</div>
      <Handle
        id={JOINT}
        type="target"
        position={Position.Left}
        className="port constraint"
        isConnectable={false}
        style={{ top: portHeight(node, "") }}
      />
    </div>
  );
}

export const Block = memo(function Block(props: NodeProps<BlockNode>) {
  return props.data.node.kind === "nonholonomic" ? <Condition {...props} /> : <Body {...props} />;
});
