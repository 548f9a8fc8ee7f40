import type { Json } from "../api/types";
import { speeds } from "../model/joints";
import { isMap } from "../model/paths";
import type { ControlProps } from "./context";
import { Expression } from "./Expression";

/** The joint's virtual power: a formula for each of its speeds. A single one keeps the form it has in the file. */
export function Effort({ value, onChange, path, label, help, joint }: ControlProps & { joint: Json | undefined }) {
  const isList = Array.isArray(value);
  const given = isList ? value : value === undefined ? [] : [value];
  const count = Math.max(isMap(joint) ? speeds(joint) : 0, given.length);
  const change = (place: number, next: Json | undefined): void => {
    const parts = Array.from({ length: count }, (_, i) => (i === place ? next : given[i]));
    if (parts.every((each) => each === undefined)) onChange(undefined);
    else if (count === 1 && !isList && value !== undefined) onChange(next);
    else onChange(parts.map((each) => each ?? 0));
  };
  if (count === 0) return <span className="quiet">a fixed joint has no speed</span>;
  return (
    <div className="stack" role="group" aria-label={label}>
      {Array.from({ length: count }, (_, i) => (
        <Expression
          key={i}
          value={given[i]}
          onChange={(next) => change(i, next)}
          path={isList || value === undefined ? [...path, i] : path}
          label={count === 1 ? label : `${label} ${i + 1}`}
          help={help}
          fallback={0}
        />
      ))}
    </div>
  );
}
