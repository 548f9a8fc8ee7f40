import { Handle, type Node, type NodeProps, Position } from "@xyflow/react";
import { memo } from "react";

import type { SignalNode, SignalPort } from "../api/types";
import { blockSize, rowHeight } from "../model/diagram_geometry";
import { Glyph } from "../shell/Glyph";
import { usePorts } from "./usePorts";

export type SignalBlockNode = Node<{ node: SignalNode; colour: string }, "signal">;

/** What stands beside a port: entries and unit of its signal. */
export function portWords({ shape, unit }: SignalPort): string {
  const size = shape === null ? "?" : shape.length === 0 ? "" : shape.join("×");
  return [size, unit].filter(Boolean).join(" ");
}

function Ports({ node, side }: { node: SignalNode; side: "inputs" | "outputs" }) {
  const isInput = side === "inputs";
  return node[side].map((port, row) => (
    <div key={port.name} className={`signal-port ${side}`} style={{ top: rowHeight(row) }}>
      <span title={`${port.name} ${portWords(port)}`.trim()}>{port.name}</span>
      <Handle
        id={`${isInput ? "in" : "out"} ${port.name}`}
        type={isInput ? "target" : "source"}
        position={isInput ? Position.Left : Position.Right}
        className={`port signal${port.fault === "" ? "" : " wrong"}`}
        role="img"
        title={port.fault || portWords(port)}
        aria-label={`${isInput ? "input" : "output"} ${port.name} of ${node.title}, ${portWords(port) || "any number"}${port.fault === "" ? "" : `: ${port.fault}`}`}
      />
    </div>
  ));
}

/** A block of a diagram: inputs on the left, outputs on the right, the model that it is about at its foot. */
export const SignalBlock = memo(function SignalBlock({ id, data: { node, colour } }: NodeProps<SignalBlockNode>) {
  usePorts(
    id,
    [node.inputs, node.outputs].map((ports) => ports.map(({ name }) => name)),
  );
  const [width, height] = blockSize(node);
  const kind = node.kind.replaceAll("_", " ");
  if (node.kind === "comment")
    return (
      <div
        className={`block comment${node.heading === true ? " heading" : ""}${node.problems > 0 ? " wrong" : ""}`}
        style={{ width, minHeight: height }}
        title={`comment ${node.title}`}
      >
        {node.note || "…"}
      </div>
    );
  return (
    <div
      className={`block signal-block ${node.group} rate ${colour}${node.problems > 0 ? " wrong" : ""}`}
      style={{ width, height }}
      title={`${kind} ${node.title}`}
    >
      <div className="block-head">
        <Glyph name={node.kind === "part" ? "part" : node.group} size={14} />
        <span className="block-title">{node.title}</span>
        {node.problems > 0 ? <span className="block-problems">{node.problems}</span> : null}
        <span className="block-note">{kind === node.title ? "" : kind}</span>
      </div>
      <Ports node={node} side="inputs" />
      <Ports node={node} side="outputs" />
      {node.note === "" ? null : <div className="block-foot">{node.note}</div>}
    </div>
  );
});
