import type { Json, Path, Sizes } from "../api/types";
import { useForm } from "../forms/context";
import { start } from "../forms/OneOf";
import { RecordField } from "../forms/Record";
import { definition } from "../forms/schema";
import { isMap, mapAt } from "../model/paths";
import { asked, fitted } from "../model/sizes";
import { Row } from "../shell/Row";
import { useStore } from "../store/store";

/** A way to state an entry: by a key that no other way has, and keys that go with it. */
interface Way {
  key: string;
  title: string;
  more: readonly string[];
  /** What the key begins with; as the schema says if not given. */
  begun?: number;
}

interface Described {
  record: string;
  ways: readonly Way[];
}

const SECTIONS: Record<string, Described> = {
  closures: { record: "ClosureEntry", ways: [] },
  connections: { record: "ConnectionEntry", ways: [] },
  contacts: {
    record: "ContactEntry",
    ways: [
      {
        key: "stiffness",
        title: "Compliant: bodies penetrate a little",
        more: ["exponent", "dissipation", "minimum_velocity", "bristle_stiffness", "bristle_damping"],
        begun: 1e5,
      },
      { key: "restitution", title: "Rigid: bodies strike, slide, stick", more: ["rim", "segment"], begun: 0.5 },
    ],
  },
  nonholonomic: {
    record: "NonholonomicEntry",
    ways: [
      { key: "knife_edge", title: "Knife edge", more: [] },
      { key: "rolling", title: "Rolling", more: [] },
      { key: "coefficients", title: "By formula", more: ["right"] },
    ],
  },
};
const NO_SIZES: Sizes = {};

interface Props {
  section: string;
  value: Json | undefined;
  onChange(value: Json | undefined): void;
  path: Path;
}

/** Entries, but not those of the given keys. */
const without = (value: Json | undefined, others: readonly string[]): [string, Json][] =>
  Object.entries(mapAt(value, [])).filter(([key]) => !others.includes(key));

/** A closure, a connection, a contact or a condition on speeds: which way it is stated, and what that way has. */
export function EntryForm({ section, value, onChange, path }: Props) {
  const { root } = useForm();
  const sizes = useStore((state) => (section === "contacts" ? state.catalogue?.sizes.contact : undefined)) ?? NO_SIZES;
  const { record, ways } = SECTIONS[section] ?? { record: "", ways: [] };
  const { shape } = definition(root, record);
  if (shape.kind !== "record") return null;
  const current = ways.find(({ key }) => isMap(value) && key in value);
  const keysOf = (way: Way | undefined): string[] => (way === undefined ? [] : [way.key, ...way.more]);
  const foreign = (way: Way | undefined): string[] => ways.flatMap(keysOf).filter((key) => !keysOf(way).includes(key));
  const change = (way: Way | undefined): void => {
    const schema = way === undefined ? undefined : shape.properties[way.key];
    if (way === undefined || !isMap(schema)) return;
    onChange({ ...Object.fromEntries(without(value, foreign(way))), [way.key]: way.begun ?? start(root, schema) });
  };
  // What the file gives is shown, even where it does not go with the way.
  const hidden = foreign(current).filter((key) => !(isMap(value) && key in value));
  const shown = asked(Object.keys(shape.properties), mapAt(value, []), sizes).filter((key) => !hidden.includes(key));
  const required = current === undefined ? shape.required : [...shape.required, current.key];
  return (
    <>
      {ways.length === 0 ? null : (
        <Row title="Kind">
          {(id) => (
            <select
              id={id}
              value={current?.key ?? ""}
              onChange={(event) => change(ways.find(({ key }) => key === event.target.value))}
            >
              {current === undefined ? <option value="">-</option> : null}
              {ways.map(({ key, title }) => (
                <option key={key} value={key}>
                  {title}
                </option>
              ))}
            </select>
          )}
        </Row>
      )}
      <RecordField
        shape={{ ...shape, required }}
        value={value}
        onChange={(next) => onChange(fitted(next, sizes))}
        path={path}
        only={shown}
      />
    </>
  );
}
