import type { Json, Path } from "../api/types";
import { isMap } from "../model/paths";
import { Effort } from "./Effort";
import { Expression } from "./Expression";
import { ListField } from "./List";
import { MapField } from "./Map";
import { Moments } from "./Moments";
import { begun, OneOf } from "./OneOf";
import { isReference, Reference } from "./Reference";
import { useForm } from "./context";
import { RecordField } from "./Record";
import type { Field } from "./schema";
import { ChoiceField, FlagField, NumberField, SetField, TextField } from "./scalars";
import { ValueField } from "./Value";
import { Matrix, partNames, Vector } from "./Vector";

interface FieldProps {
  /** The property's key: some have a widget of their own. */
  name: string;
  field: Field;
  value: Json | undefined;
  onChange(value: Json | undefined): void;
  path: Path;
  label: string;
  /** The record that the property is in. */
  siblings: Json | undefined;
}

/** The control that suits a property's shape. */
export function FieldControl({ name, field, value, onChange, path, label, siblings }: FieldProps) {
  const { choices } = useForm();
  const { shape, help, fallback } = field;
  const common = { value: value === null ? undefined : value, onChange, label, help, fallback };
  if (name === "moments") return <Moments {...common} path={path} />;
  if (name === "effort" && shape.kind !== "number") return <Effort {...common} path={path} joint={siblings} />;
  const options = shape.kind === "text" ? choices(name, siblings) : null;
  if (options !== null) return <ChoiceField {...common} options={["", ...options]} />;
  if (isReference(name, shape.kind)) return <Reference {...common} name={name} siblings={siblings} />;
  switch (shape.kind) {
    case "formula":
      return <Expression {...common} path={path} required={!field.optional} />;
    case "text":
      return <TextField {...common} isLong={name === "text"} />;
    case "value":
      return <ValueField {...common} path={path} />;
    case "number":
      return <NumberField {...common} integer={shape.integer} minimum={shape.minimum} maximum={shape.maximum} />;
    case "flag":
      return <FlagField {...common} />;
    case "choice":
      return <ChoiceField {...common} options={shape.options} />;
    case "set":
      return <SetField {...common} options={shape.options} />;
    case "vector":
      return <Vector {...common} path={path} names={partNames(name, shape.size)} />;
    case "matrix":
      return <Matrix {...common} path={path} rows={shape.rows} columns={shape.columns} />;
    case "list":
      return <ListField {...common} path={path} item={shape.item} />;
    case "map":
      return <MapField {...common} path={path} entry={shape.entry} keys={shape.keys} />;
    case "one of":
      return <OneOf {...common} path={path} properties={shape.properties} />;
    case "record":
      return <OptionalRecord {...common} path={path} field={field} />;
  }
}

/** A record that may be left out is added and removed as a whole. */
function OptionalRecord({ value, onChange, path, label, field }: Omit<FieldProps, "name" | "siblings">) {
  const { root } = useForm();
  const { shape, optional } = field;
  if (shape.kind !== "record") return null;
  if (value === undefined && optional) {
    return (
      <button type="button" className="small" onClick={() => onChange(begun(root, shape))}>
        Add {label.toLowerCase()}
      </button>
    );
  }
  // Its short form is what it can't be without.
  const short = shape.required[0];
  const record = isMap(value) || value === undefined || short === undefined ? value : { [short]: value };
  return (
    <div className="group" role="group" aria-label={label}>
      <RecordField shape={shape} value={record} onChange={onChange} path={path} />
      {optional ? (
        <button type="button" className="small quiet" onClick={() => onChange(undefined)}>
          Remove {label.toLowerCase()}
        </button>
      ) : null}
    </div>
  );
}
