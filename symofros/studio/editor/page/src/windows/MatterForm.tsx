import type { Json, JsonMap, Path } from "../api/types";
import { RecordField } from "../forms/Record";
import type { Shape } from "../forms/schema";
import { isMap } from "../model/paths";
import { Row } from "../shell/Row";

const KINDS = { inertia: "mass and moments", solid: "a solid and its density", none: "nothing: massless" } as const;
type Kind = keyof typeof KINDS;

/** What each begins with; the solid is a link of aluminium. */
const BEGUN: Record<Exclude<Kind, "none">, JsonMap> = {
  inertia: { mass: 1, center_of_mass: [0.5, 0, 0], moments: [0.01, 0.1, 0.1] },
  solid: { shape: "box", density: 2700, x: 1, y: 0.02, z: 0.02, center: [0.5, 0, 0] },
};

interface Props {
  value: Json | undefined;
  onChange(value: Json | undefined): void;
  path: Path;
  shape: Shape & { kind: "record" };
}

/** The inertia of a rigid body: stated, or that of a homogeneous solid. */
export function MatterForm({ value, onChange, path, shape }: Props) {
  const body: JsonMap = isMap(value) ? value : {};
  const kind: Kind = "solid" in body ? "solid" : "inertia" in body ? "inertia" : "none";
  const choose = (next: Kind): void => {
    const kept = Object.entries(body).filter(([key]) => key !== "inertia" && key !== "solid");
    onChange({ ...Object.fromEntries(kept), ...(next === "none" ? {} : { [next]: BEGUN[next] }) });
  };
  return (
    <>
      <Row title="Inertia by">
        {(id) => (
          <select id={id} value={kind} onChange={(event) => choose(event.target.value as Kind)}>
            {Object.entries(KINDS).map(([key, title]) => (
              <option key={key} value={key}>
                {title}
              </option>
            ))}
          </select>
        )}
      </Row>
      <RecordField
        shape={shape}
        value={value}
        onChange={onChange}
        path={path}
        only={kind === "none" ? ["waive"] : [kind, "waive"]}
      />
    </>
  );
}
