import type { Json, JsonMap, Path } from "../api/types";
import { isMap } from "../model/paths";
import { FieldControl } from "./Field";
import { useForm } from "./context";
import { isReference } from "./Reference";
import { field, label as words, type Shape } from "./schema";

interface Props {
  value: Json | undefined;
  onChange(value: Json | undefined): void;
  path: Path;
  label: string;
  properties: JsonMap;
}

/** What a record starts as: its required fields. */
export const begun = (root: JsonMap, { required, properties }: Shape & { kind: "record" }): JsonMap =>
  Object.fromEntries(required.map((key) => [key, start(root, properties[key] as JsonMap, key)]));

/** What an entry starts as. */
export function start(root: JsonMap, schema: JsonMap, name = ""): Json {
  const { shape, fallback } = field(root, schema);
  if (fallback !== undefined && fallback !== null) return fallback;
  switch (shape.kind) {
    case "formula":
      return 1;
    case "vector":
      return Array.from({ length: shape.size }, () => 0);
    case "matrix":
      return Array.from({ length: shape.rows }, (_, i) =>
        Array.from({ length: shape.columns }, (_, j) => (i === j ? 1 : 0)),
      );
    case "record":
      return begun(root, shape);
    case "list":
    case "set":
      return [];
    case "map":
    case "one of":
      return {};
    case "flag":
      return false;
    case "number":
      return shape.minimum ?? 0;
    case "choice":
      return shape.options[0] ?? "";
    case "value":
      return 0;
    case "text":
      return isReference(name, shape.kind) ? "world" : "";
  }
}

/** Exactly one of several forms, such as a rotation. */
export function OneOf({ value, onChange, path, label, properties }: Props) {
  const { root } = useForm();
  const [key] = isMap(value) ? Object.keys(value) : [];
  const schema = key === undefined ? undefined : properties[key];
  return (
    <div className="one-of">
      <select
        value={key ?? ""}
        aria-label={`${label}: form`}
        onChange={(event) => {
          const next = properties[event.target.value];
          onChange(isMap(next) ? { [event.target.value]: start(root, next) } : undefined);
        }}
      >
        <option value="">none</option>
        {Object.keys(properties).map((each) => (
          <option key={each} value={each}>
            {words(each)}
          </option>
        ))}
      </select>
      {key === undefined || !isMap(schema) ? null : (
        <FieldControl
          name={key}
          field={field(root, schema, false)}
          value={isMap(value) ? value[key] : undefined}
          onChange={(next) => onChange(next === undefined ? undefined : { [key]: next })}
          path={[...path, key]}
          label={`${label}: ${words(key)}`}
          siblings={undefined}
        />
      )}
    </div>
  );
}
