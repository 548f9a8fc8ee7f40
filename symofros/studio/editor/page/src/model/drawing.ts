/** The diagram as an SVG text of its own, for papers: no foreign objects, no style sheet, black on white. */

import type { Document, GraphEdge, GraphNode, Point } from "../api/types";
import {
  ends,
  frames,
  hasJoint,
  HEADER,
  jointHeight,
  lanes,
  mountPath,
  portHeight,
  size,
  tieMiddle,
  tiePath,
} from "./geometry";
import { GLYPHS } from "./glyphs";
import { summary } from "./summary";

const INK = "#1b2430";
const SOFT = "#5d6875";
const FILLS = {
  base: "#eef0f2",
  rigid_body: "#ffffff",
  massless_body: "#ffffff",
  beam: "#f0f6ee",
  nonholonomic: "#f7f1fa",
};
const DASHES = { joint: "", closure: "6 4", connection: "2 3", contact: "1 4", constraint: "6 2" };
const MARGIN = 24;

const escaped = (text: string): string => text.replace(/[&<>"]/g, (sign) => `&#${sign.charCodeAt(0)};`);

function label(x: number, y: number, text: string, more = ""): string {
  return `<text x="${x}" y="${y}" ${more}>${escaped(text)}</text>`;
}

function glyph(x: number, y: number, name: string): string {
  return `<path transform="translate(${x} ${y})" d="${GLYPHS[name] ?? ""}" fill="none" stroke="${INK}" stroke-width="1.2"/>`;
}

function block(document: Document, node: GraphNode): string {
  const [width, height] = size(node);
  const { joint, note } = summary(node, document.data);
  const marks = [
    `<rect width="${width}" height="${height}" rx="3" fill="${FILLS[node.kind]}" stroke="${INK}"/>`,
    glyph(6, 5, node.kind),
    label(26, 17, node.title, 'font-weight="600"'),
    `<path d="M0 ${HEADER}h${width}" stroke="#c5cbd2"/>`,
  ];
  if (node.kind === "nonholonomic") return [...marks, label(8, HEADER + 14, note, `fill="${SOFT}"`)].join("");
  marks.push(label(width - 8, 17, note, `text-anchor="end" fill="${SOFT}" font-size="10"`));
  if (joint !== null) {
    marks.push(
      glyph(8, jointHeight - 8, joint.kind),
      label(28, jointHeight + 4, joint.name, 'font-family="monospace"'),
    );
    marks.push(label(28, jointHeight + 18, joint.kind, `fill="${SOFT}" font-size="10"`));
  }
  if (hasJoint(node)) marks.push(`<rect x="-4" y="${jointHeight - 4}" width="8" height="8" fill="${INK}"/>`);
  for (const frame of frames(node)) {
    const y = portHeight(node, frame.name);
    const name = frame.kind === "origin" ? "origin" : frame.name;
    marks.push(label(width - 10, y + 4, name, `text-anchor="end" fill="${frame.kind === "origin" ? SOFT : INK}"`));
    marks.push(`<circle cx="${width}" cy="${y}" r="4" fill="#ffffff" stroke="${INK}"/>`);
  }
  return marks.join("");
}

function link(
  edge: GraphEdge,
  lane: number | undefined,
  source: GraphNode,
  target: GraphNode,
  at: readonly [Point, Point],
): string {
  const end = ends(edge, source, target);
  const from: Point = [at[0][0] + end.from[0], at[0][1] + end.from[1]];
  const to: Point = [at[1][0] + end.to[0], at[1][1] + end.to[1]];
  const dash = DASHES[edge.kind] === "" ? "" : ` stroke-dasharray="${DASHES[edge.kind]}"`;
  const path = lane === undefined ? mountPath(from, to) : tiePath(from, to, lane);
  const line = `<path d="${path}" fill="none" stroke="${INK}"${dash}/>`;
  if (lane === undefined) return line;
  const [x, y] = tieMiddle(from, to, lane);
  return (
    line +
    label(
      x + 3,
      y + 3,
      edge.label,
      `font-size="10" fill="${SOFT}" stroke="#ffffff" stroke-width="3" paint-order="stroke"`,
    )
  );
}

/** The whole diagram, with blocks at the given places. */
export function drawing(document: Document, places: Record<string, Point>): string {
  const { nodes, edges } = document.graph;
  const placed = nodes.map((node) => ({ node, at: places[node.id] ?? ([0, 0] as const), size: size(node) }));
  const left = Math.min(0, ...placed.map(({ at }) => at[0])) - MARGIN;
  const top = Math.min(0, ...placed.map(({ at }) => at[1])) - MARGIN;
  // Ties swing out to the right of the blocks that they join.
  const width = Math.max(0, ...placed.map(({ at, size: [w] }) => at[0] + w)) - left + 5 * MARGIN;
  const height = Math.max(0, ...placed.map(({ at, size: [, h] }) => at[1] + h)) - top + MARGIN;
  const lane = lanes(edges);
  const byId = new Map(placed.map((each) => [each.node.id, each]));
  const drawn = edges.flatMap((edge) => {
    const [source, target] = [byId.get(edge.source), byId.get(edge.target)];
    return source === undefined || target === undefined
      ? []
      : [link(edge, lane.get(edge.id), source.node, target.node, [source.at, target.at])];
  });
  const blocks = placed.map(
    ({ node, at }) => `<g transform="translate(${at[0]} ${at[1]})">${block(document, node)}</g>`,
  );
  return [
    `<svg xmlns="http://www.w3.org/2000/svg" width="${width}" height="${height}" viewBox="${left} ${top} ${width} ${height}" font-family="sans-serif" font-size="11" fill="${INK}">`,
    `<title>${escaped(document.name)}</title>`,
    `<rect x="${left}" y="${top}" width="${width}" height="${height}" fill="#ffffff"/>`,
    ...drawn,
    ...blocks,
    "</svg>",
    "",
  ].join("\n");
}
