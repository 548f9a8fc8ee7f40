import { Handle, type Node, type NodeProps, Position } from "@xyflow/react";
import { memo, type MouseEvent, type ReactNode } from "react";

import type { BentBeam } from "../api/jobs";
import type { GraphNode, Port } from "../api/types";
import { badge } from "../model/bending";
import { frameId } from "../model/elements";
import { frames, hasJoint, jointHeight, portHeight, size } from "../model/geometry";
import type { Summary } from "../model/summary";
import { Glyph } from "../shell/Glyph";
import { reveal, toggleFolds } from "../store/folding";
import { useBegun } from "../store/store";
import { usePorts } from "./usePorts";

export type BlockNode = Node<
  {
    node: GraphNode;
    summary: Summary;
    /** How many blocks it carries. */
    carried: number;
    /** Whether it stands for them. */
    folded: boolean;
    /** Frames that are chosen. */
    marked: readonly string[];
    /** Of a beam, how far the newest simulation of the model bends it. */
    bent: BentBeam | null;
  },
  "block"
>;

/** Ids of handles; a body's own frame has no name. */
export const JOINT = "joint";
export const frameHandle = (port: Port | undefined): string => `frame ${port?.kind === "frame" ? port.name : ""}`;
export const frameOf = (handle: string): string => handle.slice("frame ".length);

type Props = NodeProps<BlockNode>["data"];

/** Folds what a body carries into it, and back; the key F does so for the chosen blocks. */
function Fold({ node, carried, folded }: Props) {
  const label = `${folded ? "Unfold" : "Fold"} the ${carried} that ${node.title} carries`;
  return (
    <button
      type="button"
      className="block-fold nodrag"
      tabIndex={-1}
      aria-expanded={!folded}
      aria-label={label}
      title={`${label} (F)`}
      onClick={() => toggleFolds([node.id])}
    >
      {folded ? `+${carried}` : "−"}
    </button>
  );
}

/** What the beam's theory errs in the newest simulation. */
function Theory({ bent }: { bent: BentBeam | null }) {
  const words = bent === null ? "" : badge(bent);
  if (bent === null || words === "") return null;
  const title = bent.grade === "fine" ? bent.text : `${bent.text}; ${bent.remedy}`;
  return (
    <span className={`block-theory ${bent.grade}`} title={title}>
      {words}
    </span>
  );
}

/** What all blocks have: outline and head. */
function Outline({ data, note, children }: { data: Props; note: string; children: ReactNode }) {
  const { node } = data;
  const [width, height] = size(node);
  const problems = useBegun() ? node.problems : 0;
  return (
    <div className={`block ${node.kind}${problems > 0 ? " wrong" : ""}`} style={{ width, height }}>
      <div className="block-head">
        <Glyph name={node.kind} size={14} />
        <span className="block-title">{node.title}</span>
        {problems > 0 ? <span className="block-problems">{problems}</span> : null}
        <Theory bent={data.bent} />
        <span className="block-note">{note}</span>
        {data.carried > 0 ? <Fold {...data} /> : null}
      </div>
      {children}
    </div>
  );
}

function Mark({ glyph, title }: { glyph: string; title: string }) {
  return (
    <span className="block-mark" title={title}>
      <Glyph name={glyph} size={12} />
    </span>
  );
}

function JointWords({ joint }: { joint: NonNullable<Summary["joint"]> }) {
  return (
    <div className="block-joint">
      <Glyph name={joint.kind} />
      <span className="block-joint-name">{joint.name}</span>
      <span className="block-joint-kind">{joint.kind}</span>
      {joint.actuated ? <Mark glyph="motor" title="driven by a motor or an effort" /> : null}
      {joint.sprung ? <Mark glyph="spring" title="spring, damper, stop or friction" /> : null}
    </div>
  );
}

function FramePort({ node, frame, marked }: { node: GraphNode; frame: Port; marked: boolean }) {
  const name = frame.kind === "origin" ? "origin" : frame.name;
  // The body frame is the body's own.
  const choose = (event: MouseEvent): void => {
    if (frame.kind !== "frame") return;
    event.stopPropagation();
    reveal(frameId(node.path, frame.name));
  };
  return (
    <div
      className={`block-frame${marked ? " marked" : ""}`}
      style={{ top: portHeight(node, frame.name) }}
      onClick={choose}
    >
      <span className={frame.kind === "origin" ? "quiet" : ""}>{name}</span>
      <Handle
        id={frameHandle(frame)}
        type="source"
        position={Position.Right}
        className="port frame"
        role="img"
        aria-label={`frame ${name} of ${node.title}`}
      />
    </div>
  );
}

/** A body: its joint on the left, the frames that others can be put on at the right. */
function Body(data: Props) {
  const { node, summary } = data;
  return (
    <Outline data={data} note={summary.note}>
      {summary.joint === null ? null : <JointWords joint={summary.joint} />}
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
        <FramePort key={frameHandle(frame)} node={node} frame={frame} marked={data.marked.includes(frame.name)} />
      ))}
    </Outline>
  );
}

/** A condition on speeds. */
function Condition(data: Props) {
  const { node, summary } = data;
  const top = portHeight(node, "");
  return (
    <Outline data={data} note="">
      <div className="block-kind">{summary.note}</div>
      <Handle
        id={JOINT}
        type="target"
        position={Position.Left}
        className="port constraint"
        isConnectable={false}
        style={{ top }}
      />
    </Outline>
  );
}

export const Block = memo(function Block({ id, data }: NodeProps<BlockNode>) {
  usePorts(id, [data.node.kind, data.node.ports]);
  return data.node.kind === "nonholonomic" ? <Condition {...data} /> : <Body {...data} />;
});
