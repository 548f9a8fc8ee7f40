import type { Json } from "../api/types";
import { useForm } from "../forms/context";
import { FieldControl } from "../forms/Field";
import { RecordField } from "../forms/Record";
import { definition, field } from "../forms/schema";
import { at, mapAt, replaced } from "../model/paths";

interface Props {
  value: Json | undefined;
  onChange(value: Json | undefined): void;
}

const SECTIONS = [
  { key: "virtual_power", title: "Virtual power", help: "Internal forces as F(q, dq) on a speed such as dq1." },
  { key: "potentials", title: "Potential energies", help: "Formulas of coordinates, parameters and t [J]." },
  {
    key: "couplings",
    title: "Couplings of coordinates",
    help: "Formulas of coordinates and parameters that stay zero, such as q2 - 3*q1: gears, belts, mimic joints.",
  },
  { key: "include", title: "Included files", help: "Parts to merge, in the folder of this file." },
] as const;

/** Gravity alone, which acts on all bodies: in the window of the ground. */
export function GravityForm({ value, onChange }: Props) {
  const { root } = useForm();
  const { shape } = definition(root, "SystemEntry");
  if (shape.kind !== "record") return null;
  return (
    <section aria-label="Gravity">
      <h3>Gravity</h3>
      <p className="quiet">Of the whole system, in axes of the world.</p>
      <RecordField shape={shape} value={mapAt(value, [])} onChange={onChange} path={["system"]} only={["gravity"]} />
    </section>
  );
}

/** Gravity and name; what concerns several bodies; files that are included. */
export function SystemForm({ value, onChange }: Props) {
  const { root } = useForm();
  const { shape } = definition(root, "SystemEntry");
  const properties = mapAt(root, ["properties"]);
  return (
    <>
      {shape.kind === "record" ? (
        <RecordField
          shape={shape}
          value={mapAt(value, ["system"])}
          onChange={(next) => onChange(replaced(value, "system", next))}
          path={["system"]}
        />
      ) : null}
      {SECTIONS.map(({ key, title, help }) => (
        <section key={key}>
          <h3>{title}</h3>
          <p className="quiet">{help}</p>
          <FieldControl
            name={key}
            field={field(root, mapAt(properties, [key]))}
            value={at(value, [key])}
            onChange={(next) => onChange(replaced(value, key, next))}
            path={[key]}
            label={title}
            siblings={undefined}
          />
        </section>
      ))}
    </>
  );
}
