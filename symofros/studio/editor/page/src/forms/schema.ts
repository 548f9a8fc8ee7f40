/** The published JSON Schema as shapes that forms are drawn from: only the constructs that it uses. */

import type { Json, JsonMap } from "../api/types";
import { isMap, mapAt, textAt } from "../model/paths";

export type Shape =
  | { kind: "formula" }
  | { kind: "number"; integer: boolean; minimum: number | null; maximum: number | null }
  | { kind: "text" }
  /** Anything that fits on a line of the file. */
  | { kind: "value" }
  | { kind: "flag" }
  | { kind: "choice"; options: string[] }
  | { kind: "set"; options: string[] }
  | { kind: "vector"; size: number }
  | { kind: "matrix"; rows: number; columns: number }
  | { kind: "list"; item: JsonMap }
  | { kind: "map"; entry: JsonMap; keys: string[] | null }
  | { kind: "record"; name: string; properties: JsonMap; required: string[] }
  | { kind: "one of"; properties: JsonMap };

export interface Field {
  shape: Shape;
  help: string;
  unit: string;
  fallback: Json | undefined;
  /** Whether it may be left out of what holds it. */
  optional: boolean;
}

const strings = (value: Json | undefined): string[] => (Array.isArray(value) ? value.map(String) : []);
const numberOf = (value: Json | undefined): number | null => (typeof value === "number" ? value : null);

/** A schema with its reference followed; words beside the reference stand before those behind it. */
function resolved(root: JsonMap, schema: JsonMap): JsonMap {
  const reference = textAt(schema, ["$ref"]);
  if (reference === undefined) return schema;
  const name = reference.replace("#/$defs/", "");
  return { ...resolved(root, mapAt(root, ["$defs", name])), ...schema, $name: name };
}

/** What is left of an `anyOf` without null, if it is one thing. */
function given(root: JsonMap, schema: JsonMap): JsonMap {
  const branches = (Array.isArray(schema["anyOf"]) ? schema["anyOf"] : []).filter(isMap);
  const real = branches.filter((branch) => branch["type"] !== "null");
  const first = real[0];
  if (first === undefined) return schema;
  const { anyOf: _, ...beside } = schema;
  // Ways that have no name of their own: as one writes them in the file.
  if (real.length > 1 && !real.some((branch) => "$ref" in branch)) return beside;
  // Several ways to write one thing: the richest one can be edited, the others are read.
  const rich = real.find((branch) => "$ref" in branch && branch["$ref"] !== "#/$defs/Formula") ?? first;
  return { ...resolved(root, rich), ...beside };
}

function arrayShape(root: JsonMap, schema: JsonMap): Shape {
  const items = mapAt(schema, ["items"]);
  const size = numberOf(schema["minItems"]);
  const fixed = size !== null && size === schema["maxItems"];
  if (fixed && items["$ref"] === "#/$defs/Formula") return { kind: "vector", size };
  if (fixed && items["type"] === "array")
    return { kind: "matrix", rows: size, columns: numberOf(items["minItems"]) ?? size };
  const options = strings(resolved(root, items)["enum"]);
  return options.length > 0 ? { kind: "set", options } : { kind: "list", item: items };
}

function objectShape(schema: JsonMap): Shape {
  if ("properties" in schema) {
    const properties = mapAt(schema, ["properties"]);
    if (schema["maxProperties"] === 1) return { kind: "one of", properties };
    return { kind: "record", name: textAt(schema, ["$name"]) ?? "", properties, required: strings(schema["required"]) };
  }
  const keys = strings(mapAt(schema, ["propertyNames"])["enum"]);
  return { kind: "map", entry: mapAt(schema, ["additionalProperties"]), keys: keys.length > 0 ? keys : null };
}

function shapeOf(root: JsonMap, schema: JsonMap): Shape {
  if (schema["$name"] === "Formula") return { kind: "formula" };
  if (Array.isArray(schema["enum"])) return { kind: "choice", options: strings(schema["enum"]) };
  switch (schema["type"]) {
    case "boolean":
      return { kind: "flag" };
    case "integer":
    case "number": {
      const integer = schema["type"] === "integer";
      return { kind: "number", integer, minimum: numberOf(schema["minimum"]), maximum: numberOf(schema["maximum"]) };
    }
    case "array":
      return arrayShape(root, schema);
    case "object":
      return objectShape(schema);
    case undefined:
      return { kind: "value" };
    default:
      return { kind: "text" };
  }
}

/** The unit that a description ends in, such as `[kg m^2]`. */
function unitOf(help: string): string {
  return /\[([^\]]+)\]/.exec(help)?.[1] ?? "";
}

export function field(root: JsonMap, schema: JsonMap, optional = true): Field {
  const outer = resolved(root, schema);
  const inner = outer["$name"] === "Formula" ? outer : given(root, outer);
  const help =
    textAt(schema, ["description"]) ?? (inner["$name"] === "Formula" ? "" : (textAt(inner, ["description"]) ?? ""));
  const unit = unitOf(help);
  return {
    shape: shapeOf(root, inner),
    // Descriptions are of Python's fields: an entry that is None there is left out of the file.
    help: help === `[${unit}]` ? "" : help.replaceAll("None:", "left out:"),
    unit,
    fallback: schema["default"],
    optional,
  };
}

/** A definition by its name. */
export const definition = (root: JsonMap, name: string): Field => field(root, { $ref: `#/$defs/${name}` });

const LABELS: Record<string, string> = {
  rpy: "Roll, pitch, yaw",
  axis_angle: "Axis and angle",
  bend_y: "Shape functions along y",
  bend_z: "Shape functions along z",
  twist: "Shape functions of twist",
  stretch: "Shape functions of stretch",
  shear_y: "Shape functions of shear along y",
  shear_z: "Shape functions of shear along z",
  family: "Family of shape functions",
  retain: "Elastic terms retained",
  kp: "Proportional gain",
  ki: "Integral gain",
  kd: "Derivative gain",
  axis2: "Second axis",
  at: "At",
  // A signal has a period of its own.
  period: "Sample time",
  offset: "First sample",
  kind_: "Form",
  rtol: "Relative tolerance",
  rho: "Density",
  machine_states: "States",
  t0: "Start",
  t_end: "End",
  dt: "Step",
  record: "Record every",
  realtime: "Pace",
  // What a key means in one record alone.
  "JointEntry.name": "Joint name", // The window has the name of the body, too.
  "ContactEntry.first": "Frame of the balls",
  "ContactEntry.second": "Frame of the surface",
  "ContactEntry.radius": "Radius of the balls",
  "ContactEntry.points": "Centres of the balls",
  "ContactEntry.rim": "Radius of the rim",
  "ContactEntry.segment": "Length of the segment",
  "noise.kind_": "Distribution",
  "sequence.kind_": "Between samples",
  "chirp.first": "First frequency",
  "chirp.last": "Last frequency",
  "square.first": "First side",
  "square.second": "Second side",
};

/** Units that no description states in brackets. */
const UNITS: Record<string, string> = {
  ...Object.fromEntries(["period", "every", "t0", "t_end", "dt", "record"].map((key) => [key, "s"])),
  realtime: "× clock",
};

/** Unit of a property: what its description says, or what all properties of that name have; a flag has none. */
export const unitOfField = (key: string, { unit, shape }: Field): string =>
  shape.kind === "flag" ? "" : unit || (UNITS[key] ?? "");

/** A property's name in words, in a record of the schema; symbols such as EI_z stay as they are. */
export function label(key: string, record = ""): string {
  const stated = LABELS[`${record}.${key}`] ?? LABELS[key];
  if (stated !== undefined) return stated;
  if (/[A-Z]/.test(key)) return key;
  const words = key.replaceAll("_", " ");
  return words.charAt(0).toUpperCase() + words.slice(1);
}
