/** What the server sends and takes: the contract of symofros/studio/editor/server/app.py. */

import type { BentBeam } from "./jobs";

export type Json = null | boolean | number | string | Json[] | { [key: string]: Json };
export type JsonMap = { [key: string]: Json };
export type Key = string | number;
export type Path = readonly Key[];
export type Point = readonly [number, number];

export interface Fault {
  object: string;
  found: string;
  rule: string;
  remedy: string;
}

export interface Problem extends Fault {
  path: Path;
  line: number;
  node: string;
}

export interface Port {
  name: string;
  kind: "root" | "origin" | "frame";
}

export type NodeKind = "base" | "rigid_body" | "massless_body" | "beam" | "nonholonomic";
export type EdgeKind = "joint" | "closure" | "connection" | "contact" | "constraint";

export interface GraphNode {
  id: string;
  kind: NodeKind;
  title: string;
  subtitle: string;
  path: Path;
  ports: Port[];
  problems: number;
}

export interface GraphEdge {
  id: string;
  kind: EdgeKind;
  source: string;
  source_port: string;
  target: string;
  target_port: string;
  path: Path;
  label: string;
}

export interface Graph {
  nodes: GraphNode[];
  edges: GraphEdge[];
}

/** Where a signal enters or leaves a block of a diagram. */
export interface SignalPort {
  name: string;
  /** Null as long as nothing tells. */
  shape: number[] | null;
  unit: string;
  /** Whether an input must be fed. */
  required: boolean;
  /** What is wrong with what feeds an input; "" if nothing. */
  fault: string;
}

export interface SignalNode {
  id: string;
  /** The kind of block; `model` and `part` for these. */
  kind: string;
  group: string;
  title: string;
  /** What stands at its foot; of a comment, what it says. */
  note: string;
  /** Whether a comment is a heading. */
  heading?: boolean;
  path: Path;
  /** Seconds between samples; null: continuous. */
  period: number | null;
  inputs: SignalPort[];
  outputs: SignalPort[];
  problems: number;
}

export interface Wire {
  id: string;
  source: string;
  source_port: string;
  target: string;
  target_port: string;
  path: Path;
  period: number | null;
  fault: string;
  /** Whether it closes an algebraic loop with others. */
  loop: boolean;
}

/** Names in a model of a diagram. */
export interface ModelNames {
  frames: string[];
  q: string[];
  v: string[];
  parameters: string[];
}

export interface Diagram {
  nodes: SignalNode[];
  wires: Wire[];
  models: Record<string, ModelNames>;
  /** Blocks that move a mechanism; empty while there are problems. */
  moving: string[];
}

/** A file whose native code a diagram would run. */
export interface NativeFile {
  path: string;
  blocks: string[];
  bytes: number;
  /** SHA-256 of its bytes, in hexadecimal. */
  digest: string;
  /** The account that owns it. */
  owner: string;
  /** What it states of itself; "" where it states nothing. */
  model: string;
  author: string;
  tool: string;
}

export interface Parameter {
  name: string;
  value: Json;
  unit: string;
  constant: boolean;
  number: number | null;
  /** Why its unit is none; "" where it is one, or there is none. */
  unit_fault: string;
}

export interface Document {
  path: string;
  name: string;
  revision: number;
  dirty: boolean;
  /** How many edits are in force. */
  step: number;
  can_undo: boolean;
  can_redo: boolean;
  undo_label: string | null;
  redo_label: string | null;
  text: string;
  data: JsonMap;
  layout: Record<string, Point>;
  /** How many blocks are too many to be drawn, of the page's own reckoning; 0 where all are drawn. */
  undrawn: number;
  /** Of a mechanism; empty of a diagram. */
  graph: Graph;
  /** Of a diagram; null of a mechanism. */
  diagram: Diagram | null;
  /** Paths of the documents that one came through to this one. */
  trail: string[];
  problems: Problem[];
  parameters: Parameter[];
  /** Inputs that could be read. */
  inputs: { name: string; unit: string; unit_fault: string }[];
  /** Element -> the first and the last line that define it; empty while the text can't be read. */
  lines: Record<string, readonly [number, number]>;
  recovered: boolean;
  /** Somebody else wrote the file since it was read or saved. */
  disk_changed: boolean;
  /** Why unsaved work could not be kept beside the file, if it could not. */
  unkept: Fault | null;
}

export type Edit =
  | { op: "set"; path: Path; value: Json }
  /** As somebody typed it: a number keeps its figures, such as 8.0e-4. */
  | { op: "set"; path: Path; text: string }
  | { op: "remove"; path: Path }
  | { op: "insert"; path: Path; key: string; value: Json }
  | { op: "insert"; path: Path; index: number; value: Json }
  | { op: "rename"; path: Path; to: string }
  | { op: "move"; path: Path; index: number };

export interface PaletteItem {
  kind: string;
  title: string;
  help: string;
  template: Json;
  section: string;
  name: string;
}

/** An entry of a diagram's palette. */
export interface BlockItem extends PaletteItem {
  group: string;
  /** Page of the documentation, and its section. */
  page?: string;
  /** All that its author says of it. */
  about?: string;
}

/** What is known of diagrams as such. */
export interface DiagramCatalogue {
  schema: JsonMap;
  groups: { key: string; title: string }[];
  palette: BlockItem[];
}

export interface Method {
  name: string;
  adaptive: boolean;
  order: number;
  help: string;
}

/** By shape. */
export type Sizes = Record<string, string[]>;

export interface Catalogue {
  schema: JsonMap;
  palette: PaletteItem[];
  methods: Method[];
  units: string[];
  targets: string[];
  /** Sizes of each shape of a section and of a solid; entries of each surface of a contact. */
  sizes: Record<"section" | "solid" | "contact", Sizes>;
  diagram: DiagramCatalogue;
  version?: string;
}

/** Of the user's library. */
export interface LibraryPart {
  name: string;
  path: string;
  bodies: string[];
}

/** Bodies with what they use, on their way from one place to another. */
export interface Part {
  name: string;
  parameters: JsonMap;
  inputs: JsonMap;
  bodies: JsonMap;
  /** What stands between the bodies, or on one, by its section. */
  links: JsonMap;
  /** Switches of these links, by their names. */
  switches: JsonMap;
  /** The body that stands still where the part was taken from. */
  ground: string;
}

/** A model or a diagram to begin with. */
export interface Example {
  name: string;
  title: string;
  about: string;
  kind: "mechanism" | "diagram";
  picture: string;
}

export interface FileEntry {
  kind: "mechanism" | "diagram";
  path: string;
  bytes: number;
}

export interface Checked {
  ok: boolean;
  value?: number | null;
  names?: string[];
  error?: { found: string; rule: string; remedy: string; column: number | null };
}

export interface Curves {
  xi: number[];
  curves: { values: number[]; length: boolean }[];
}

/** What a beam's section brings, and the first natural frequencies of each direction [Hz]. */
export interface BeamFigures {
  section: Record<string, number>;
  frequencies: Record<string, number[]>;
  /** How far it may bend for an error of its theory: slope [rad] and deflection [m] of the tip under a force there. */
  validity: { error: number; slope: number; deflection: number }[];
}

/** Of a rigid body [kg, m, kg m^2]; moments and products about the mass centre, along the axes of the body frame. */
export interface InertiaFigures {
  mass: number;
  center_of_mass: number[];
  moments: number[];
  products: number[];
}

/** What moves the 3-D view: one degree of freedom. */
export interface Coordinate {
  name: string;
  unit: string;
  low: number;
  high: number;
  elastic: boolean;
}

/** Where the 3-D view stands. */
export interface Stand {
  q: Record<string, number>;
  exaggeration: number;
  /** Largest residual of the conditions that close loops; null where there are none. */
  gap: number | null;
  /** Its unit; "" of a formula. */
  gap_unit: string;
  /** Whether frames are drawn. */
  frames: boolean;
  /** Whether forces and moments of a run are drawn as arrows. */
  forces: boolean;
  /** Their scales, or why there are none. */
  legend: string[];
  beams: BentBeam[];
}

export interface View extends Stand {
  address: string;
  coordinates: Coordinate[];
  flexible: boolean;
  /** Names of the parameters that move it at once; others need the model to be built anew. */
  run_time: string[];
  /** Height of the picture at the depth of what its camera looks at [m]; null while several pages look, or none. */
  height: number | null;
  /** Why it is not the document as it is now, but the last one that could be shown. */
  fault: Fault | null;
}

export interface Pose {
  q?: Record<string, number>;
  par?: Record<string, number>;
  exaggeration?: number;
  reset?: boolean;
  /** A frame that gets a handle, by which it is dragged; "" for none. */
  drag?: string;
  dark?: boolean;
  /** Whether frames are drawn, and their names; bodies are seen through then. */
  frames?: boolean;
  labels?: boolean;
  /** Whether arrows of forces and of moments are drawn, at instants of a run. */
  forces?: boolean;
  moments?: boolean;
  /** Elements that are drawn in the colour of what is chosen. */
  marked?: readonly string[];
  /** A run, whose state at a time is shown; of a diagram's run, of the mechanism that a block moves. */
  run?: string;
  block?: string;
  t?: number;
}

export interface Posed extends Stand {
  /** Why the loops can't be closed there: then nothing has moved. */
  why: string;
}
