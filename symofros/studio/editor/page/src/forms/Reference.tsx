import type { Json, JsonMap } from "../api/types";
import { bodyNames, frameNames } from "../model/names";
import { replaced, textAt } from "../model/paths";
import { useForm } from "./context";

const BODY_KEYS = ["parent", "body", "carrier"];

interface Props {
  name: string;
  value: Json | undefined;
  onChange(value: Json | undefined): void;
  label: string;
  help: string;
  fallback: Json | undefined;
  siblings: Json | undefined;
}

/** Whether a property names a body or a frame, so that it is chosen, not typed. */
export function isReference(name: string, type: string): boolean {
  return type === "text" && (BODY_KEYS.includes(name) || name === "frame" || name === "at");
}

/** A record with one property changed: the frame of another body goes with that body, unless the new one has it, too. */
export function changed(data: JsonMap, record: Json | undefined, name: string, next: Json | undefined): Json {
  const value = replaced(record, name, next);
  const frame = textAt(value, ["frame"]);
  if (!BODY_KEYS.includes(name) || frame === undefined) return value;
  const isKnown = typeof next === "string" && frameNames(data, next).includes(frame);
  return isKnown ? value : replaced(value, "frame", undefined);
}

function Options({ name, siblings, without }: { name: string; siblings: Json | undefined; without: string }) {
  const { data, body } = useForm();
  let names: string[];
  if (name === "at") names = ["body", "center_of_mass", ...frameNames(data, body ?? "")];
  else if (name === "frame")
    names = frameNames(data, textAt(siblings, ["body"]) ?? textAt(siblings, ["parent"]) ?? "world");
  else names = ["world", ...bodyNames(data)].filter((each) => each !== body || name !== "parent");
  return [...new Set(names)].filter((each) => each !== without).map((each) => <option key={each}>{each}</option>);
}

/** A body or a frame by name. */
export function Reference({ name, value, onChange, label, help, fallback, siblings }: Props) {
  const { hint } = useForm();
  const empty =
    name === "frame"
      ? "(body frame)"
      : name === "carrier"
        ? "(the parent)"
        : typeof fallback === "string"
          ? fallback
          : "-";
  const current = typeof value === "string" ? value : "";
  return (
    <select
      value={current}
      aria-label={label}
      aria-description={help}
      onFocus={() => hint(help)}
      onChange={(event) => onChange(event.target.value === "" ? undefined : event.target.value)}
    >
      <option value="">{empty}</option>
      {current === "" ? null : <option hidden>{current}</option>}
      <Options name={name} siblings={siblings} without={empty} />
    </select>
  );
}
