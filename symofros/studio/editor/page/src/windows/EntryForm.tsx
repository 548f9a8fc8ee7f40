import type { Json, Path } from "../api/types";
import { useForm } from "../forms/context";
import { start } from "../forms/OneOf";
import { RecordField } from "../forms/Record";
import { definition } from "../forms/schema";
import { isMap } from "../model/paths";

const RECORDS: Record<string, string> = {
  closures: "ClosureEntry",
  connections: "ConnectionEntry",
  nonholonomic: "NonholonomicEntry",
};

const CONDITIONS = [
  { key: "knife_edge", title: "Knife edge" },
  { key: "rolling", title: "Rolling" },
  { key: "coefficients", title: "By formula" },
] as const;

interface Props {
  section: string;
  value: Json | undefined;
  onChange(value: Json | undefined): void;
  path: Path;
}

/** Which of the three forms a condition on speeds has. */
function ConditionKind({ value, onChange }: Pick<Props, "value" | "onChange">) {
  const { root } = useForm();
  const { shape } = definition(root, "NonholonomicEntry");
  const current = CONDITIONS.find(({ key }) => isMap(value) && key in value)?.key ?? "";
  const change = (key: string): void => {
    const schema = shape.kind === "record" ? shape.properties[key] : undefined;
    if (isMap(schema)) onChange({ [key]: start(root, schema) });
  };
  return (
    <div className="row">
      <span className="row-label" aria-hidden="true">
        Kind
      </span>
      <div className="row-control">
        <select value={current} aria-label="Kind" onChange={(event) => change(event.target.value)}>
          {current === "" ? <option value="">-</option> : null}
          {CONDITIONS.map(({ key, title }) => (
            <option key={key} value={key}>
              {title}
            </option>
          ))}
        </select>
      </div>
    </div>
  );
}

/** A closure, a connection or a condition on speeds. */
export function EntryForm({ section, value, onChange, path }: Props) {
  const { root } = useForm();
  const { shape } = definition(root, RECORDS[section] ?? "ClosureEntry");
  if (shape.kind !== "record") return null;
  if (section !== "nonholonomic") return <RecordField shape={shape} value={value} onChange={onChange} path={path} />;
  const given = isMap(value) ? Object.keys(value) : [];
  const only = given.includes("coefficients") ? ["coefficients", "right"] : given;
  return (
    <>
      <ConditionKind value={value} onChange={onChange} />
      <RecordField shape={{ ...shape, required: only }} value={value} onChange={onChange} path={path} only={only} />
    </>
  );
}
