import type { Json } from "../api/types";
import type { ControlProps } from "./context";
import { Expression } from "./Expression";

interface Props extends ControlProps {
  names: readonly string[];
  fallback: Json | undefined;
}

/** Formulas side by side; all empty means: left out. */
export function Vector({ value, onChange, path, label, help, names, fallback }: Props) {
  const parts = Array.isArray(value) ? value : [];
  const defaults = Array.isArray(fallback) ? fallback : names.map(() => 0);
  const change = (place: number, part: Json | undefined): void => {
    const next = names.map((_, i) => (i === place ? part : parts[i]));
    if (next.every((each) => each === undefined)) onChange(undefined);
    else onChange(next.map((each, i) => each ?? defaults[i] ?? 0));
  };
  return (
    <div className="vector" role="group" aria-label={label}>
      {names.map((name, i) => (
        <label key={name} className="part">
          <span className="part-name" aria-hidden="true">
            {name}
          </span>
          <Expression
            value={parts[i]}
            onChange={(part) => change(i, part)}
            path={[...path, i]}
            label={`${label} ${name}`}
            help={help}
            fallback={Array.isArray(fallback) ? fallback[i] : undefined}
          />
        </label>
      ))}
    </div>
  );
}

interface MatrixProps extends Omit<Props, "names" | "fallback"> {
  rows: number;
  columns: number;
}

/** Rows of formulas; starts as the identity. */
export function Matrix({ value, onChange, path, label, help, rows, columns }: MatrixProps) {
  const identity = Array.from({ length: rows }, (_, i) => Array.from({ length: columns }, (_, j) => (i === j ? 1 : 0)));
  const given = Array.isArray(value) ? value : identity;
  const names = Array.from({ length: columns }, (_, j) => String(j + 1));
  return (
    <div className="matrix" role="group" aria-label={label}>
      {identity.map((row, i) => (
        <Vector
          key={i}
          value={given[i]}
          onChange={(next) => onChange(given.map((each, k) => (k === i ? (next ?? row) : each)))}
          path={[...path, i]}
          label={`${label}, row ${i + 1}`}
          help={help}
          names={names}
          fallback={row}
        />
      ))}
    </div>
  );
}

const AXES = ["x", "y", "z"];
const NAMES: Record<string, readonly string[]> = {
  rpy: ["roll", "pitch", "yaw"],
  axis_angle: ["x", "y", "z", "angle"],
  quaternion: ["x", "y", "z", "w"],
};

export function partNames(key: string, size: number): readonly string[] {
  if (key.endsWith("_center")) return AXES.slice(1); // A point of a section.
  return NAMES[key] ?? (size === 3 ? AXES : Array.from({ length: size }, (_, i) => String(i + 1)));
}
