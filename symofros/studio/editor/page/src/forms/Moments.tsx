import type { Json } from "../api/types";
import { isMap, replaced } from "../model/paths";
import type { ControlProps } from "./context";
import { Expression } from "./Expression";

const NAMES = ["Ixx", "Iyy", "Izz", "Ixy", "Ixz", "Iyz"] as const;

/** Moments and products of inertia, kept in the form that the file has them in: a list of three or six, or by name. */
export function Moments({ value, onChange, path, help }: ControlProps) {
  const list = Array.isArray(value) ? value : [];
  const byName = isMap(value);
  const part = (i: number): Json | undefined => (byName ? value[(NAMES[i] ?? "").toLowerCase()] : list[i]);
  const change = (place: number, next: Json | undefined): void => {
    if (byName) {
      onChange(replaced(value, (NAMES[place] ?? "").toLowerCase(), next));
      return;
    }
    const parts = NAMES.map((_, i) => (i === place ? next : list[i]));
    const products = parts.slice(3);
    const kept = products.every((each) => each === undefined || each === 0) ? parts.slice(0, 3) : parts;
    onChange(kept.every((each) => each === undefined) ? undefined : kept.map((each) => each ?? 0));
  };
  return (
    <div className="vector moments" role="group" aria-label="Moments">
      {NAMES.map((name, i) => (
        <label key={name} className="part">
          <span className="part-name" aria-hidden="true">
            {name}
          </span>
          <Expression
            value={part(i)}
            onChange={(next) => change(i, next)}
            path={[...path, byName ? name.toLowerCase() : i]}
            label={name}
            help={help}
            fallback={0}
          />
        </label>
      ))}
    </div>
  );
}
