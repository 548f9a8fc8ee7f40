import type { Json, Path } from "../api/types";
import { useForm } from "../forms/context";
import { FieldControl } from "../forms/Field";
import { RecordField } from "../forms/Record";
import { definition, type Field, field } from "../forms/schema";
import { at, mapAt, replaced } from "../model/paths";

interface Props {
  value: Json | undefined;
  onChange(value: Json | undefined): void;
}

const SECTIONS = [
  { key: "virtual_power", title: "Virtual power", help: "Internal forces as F(q, dq) on a speed such as dq1." },
  { key: "potentials", title: "Potential energies", help: "Formulas of coordinates, parameters and t [J]." },
  {
    key: "states",
    title: "States of forces",
    help: "Formulas of their rates; formulas of forces may name them. They begin at zero.",
  },
  {
    key: "couplings",
    title: "Couplings of coordinates",
    help: "Formulas of coordinates and parameters that stay zero, such as q2 - 3*q1: gears, belts, mimic joints.",
  },
  {
    key: "switches",
    title: "Switches",
    help: "When closures, couplings and conditions on speeds hold: engaged or released.",
  },
  {
    key: "events",
    title: "Events",
    help: "What each run looks for, and does there: zeros of formulas, and what is set at them.",
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

/** When a constraint holds. */
export function SwitchForm({ value, onChange, path }: Props & { path: Path }) {
  const { root } = useForm();
  return (
    <section aria-label="Switch">
      <h3>Switch</h3>
      <p className="quiet">With one the constraint can be released, from the start or by an action of a run.</p>
      <FieldControl
        name="switch"
        field={definition(root, "SwitchEntry")}
        value={value}
        onChange={onChange}
        path={path}
        label="Switch"
        siblings={undefined}
      />
    </section>
  );
}

/** The names of an entry's parts where they are chosen, not typed: switches are of constraints. */
function chosen(described: Field, key: string, value: Json | undefined): Field {
  if (key !== "switches" || described.shape.kind !== "map") return described;
  const keys = ["closures", "couplings", "nonholonomic"].flatMap((section) => Object.keys(mapAt(value, [section])));
  return { ...described, shape: { ...described.shape, keys } };
}

/** Gravity and name; what concerns several bodies; files that are included. It opens at the section of `entry`. */
export function SystemForm({ value, onChange, entry }: Props & { entry: Path }) {
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
        <section key={key} data-first={key === entry[0] || undefined}>
          <h3>{title}</h3>
          <p className="quiet">{help}</p>
          <FieldControl
            name={key}
            field={chosen(field(root, mapAt(properties, [key])), key, value)}
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
