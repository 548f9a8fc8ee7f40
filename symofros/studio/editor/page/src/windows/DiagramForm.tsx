import type { Json, JsonMap, Path, SignalNode, SignalPort } from "../api/types";
import { portWords } from "../canvas/SignalBlock";
import { useForm } from "../forms/context";
import { RecordField } from "../forms/Record";
import { definition, field, type Field } from "../forms/schema";
import { isMap, mapAt, replaced, textAt } from "../model/paths";
import { signalName } from "../store/diagram";
import { useDocument } from "../store/store";

interface Props {
  value: Json | undefined;
  onChange(value: Json | undefined): void;
  path: Path;
}

/** The schema of a diagram's entry. */
function described(root: JsonMap, path: Path, value: Json | undefined): Field {
  const section = String(path[0]);
  if (section === "blocks") return definition(root, textAt(value, ["kind"]) ?? "");
  const entry = mapAt(root, ["properties", section]);
  return field(root, path.length === 1 ? entry : mapAt(entry, ["additionalProperties"]));
}

/** What feeds one input. */
function InputRow({ node, port, value, onChange }: { node: string; port: SignalPort } & Omit<Props, "path">) {
  const diagram = useDocument().diagram;
  const sources = (diagram?.nodes ?? []).flatMap((each: SignalNode) =>
    each.outputs.map((output) => ({ name: signalName(each, output.name), words: portWords(output) })),
  );
  const wire = diagram?.wires.find((each) => each.target === node && each.target_port === port.name);
  const from = diagram?.nodes.find(({ id }) => id === wire?.source);
  // However the file abbreviates it: a block with one output may go without the port.
  const shown = typeof value !== "string" ? "" : wire && from ? signalName(from, wire.source_port) : value;
  return (
    <div className="row">
      <span className="row-label" aria-hidden="true">
        {port.name}
      </span>
      <div className="row-control">
        <select
          value={shown}
          aria-label={`Source of ${port.name}`}
          onChange={(event) => onChange(event.target.value === "" ? undefined : event.target.value)}
        >
          <option value="">{port.required ? "not connected" : "(its default)"}</option>
          {shown !== "" && !sources.some(({ name }) => name === shown) ? <option>{shown}</option> : null}
          {sources.map(({ name, words }) => (
            <option key={name} value={name}>
              {name} {words === "" ? "" : `(${words})`}
            </option>
          ))}
        </select>
        {port.fault === "" || shown === "" ? null : (
          <div className="complaint" role="alert">
            {port.fault}
          </div>
        )}
      </div>
      <span className="row-unit">{portWords(port)}</span>
    </div>
  );
}

/** A block's fields, then what feeds its inputs; or the fields of a model, a part, the simulation. */
export function DiagramForm({ value, onChange, path }: Props) {
  const { root } = useForm();
  const nodes = useDocument().diagram?.nodes ?? [];
  const { shape, help } = described(root, path, value);
  if (shape.kind !== "record") return <p className="quiet">Its kind is not known: change it in the text.</p>;
  const own = Object.keys(shape.properties).filter((key) => !["kind", "inputs", "period", "offset"].includes(key));
  const isBlock = path[0] === "blocks";
  const node = nodes.find(({ id }) => id === path.join("/"));
  const inputs = isMap(value) && isMap(value["inputs"]) ? value["inputs"] : {};
  return (
    <>
      {isBlock ? (
        <p className="quiet block-help">
          <b>{textAt(value, ["kind"])?.replaceAll("_", " ")}</b>: {help}
        </p>
      ) : null}
      <RecordField
        shape={shape}
        value={value}
        onChange={onChange}
        path={path}
        only={isBlock ? [...own, "period", "offset"] : own}
      />
      {node === undefined || node.inputs.length === 0 ? null : (
        <section className="rows" aria-label="Inputs">
          <h3>Inputs</h3>
          {node.inputs.map((port) => (
            <InputRow
              key={port.name}
              node={node.id}
              port={port}
              value={inputs[port.name]}
              onChange={(next) => {
                const all = replaced(inputs, port.name, next);
                onChange(replaced(value, "inputs", isMap(all) && Object.keys(all).length > 0 ? all : undefined));
              }}
            />
          ))}
        </section>
      )}
    </>
  );
}
