import type { Json, Path } from "../api/types";
import { at, isMap, mapAt, same } from "../model/paths";
import { useStore } from "../store/store";
import { useForm } from "./context";
import { FieldControl } from "./Field";
import { unitAt } from "../model/joints";
import { changed } from "./Reference";
import { field, label, type Shape, unitOfField } from "./schema";

interface Props {
  shape: Shape & { kind: "record" };
  value: Json | undefined;
  onChange(value: Json | undefined): void;
  path: Path;
  /** Which properties, and in what order; all if not given. */
  only?: readonly string[];
}

/** What the last check said of a field, as long as the field is as it was then. */
function useComplaint(path: Path, value: Json | undefined): string | null {
  const { data } = useForm();
  const problems = useStore((state) => state.document?.problems);
  const problem = problems?.find(
    (each) => each.path.length === path.length && each.path.every((key, i) => key === path[i]),
  );
  return problem !== undefined && same(at(data, path), value) ? `${problem.found}. ${problem.remedy}` : null;
}

function Row({
  name,
  record,
  onChange,
  path,
  shape,
}: {
  name: string;
  record: Json | undefined;
  onChange: Props["onChange"];
  path: Path;
  shape: Props["shape"];
}) {
  const { root, data, draft } = useForm();
  const schema = shape.properties[name];
  const value = isMap(record) ? record[name] : undefined;
  const place = [...path, name];
  const complaint = useComplaint(place, value);
  if (!isMap(schema)) return null;
  const described = field(root, schema, !shape.required.includes(name));
  const words = label(name, shape.name);
  const entry = draft(place)?.value;
  const unit = unitAt(isMap(entry) ? mapAt(entry, ["joint"]) : {}, unitOfField(name, described));
  const isFormula = described.shape.kind === "formula" || described.shape.kind === "vector";
  return (
    <div className="row">
      <span className="row-label" aria-hidden="true" title={described.help}>
        {words}
      </span>
      <div className="row-control">
        <FieldControl
          name={name}
          field={described}
          value={value}
          onChange={(next) => onChange(changed(data, record, name, next))}
          path={place}
          label={words}
          siblings={record}
        />
        {complaint === null || (isFormula && value !== undefined) ? null : (
          <div className="complaint" role="alert">
            {complaint}
          </div>
        )}
      </div>
      <span className="row-unit">{unit}</span>
    </div>
  );
}

/** The properties of a record, one a row. */
export function RecordField({ shape, value, onChange, path, only }: Props) {
  const names = only ?? Object.keys(shape.properties);
  return (
    <div className="rows">
      {names.map((name) => (
        <Row key={name} name={name} record={value} onChange={onChange} path={path} shape={shape} />
      ))}
    </div>
  );
}
