import type { Json, JsonMap, Path, Sizes } from "../api/types";
import { useForm } from "../forms/context";
import { RecordField } from "../forms/Record";
import { definition, type Shape } from "../forms/schema";
import { isMap, mapAt } from "../model/paths";
import { asked, fitted } from "../model/sizes";
import { Row } from "../shell/Row";
import { useStore } from "../store/store";
import { InertiaFigures } from "./InertiaFigures";

const KINDS = { inertia: "mass and moments", solid: "a solid and its density", none: "nothing: massless" } as const;
type Kind = keyof typeof KINDS;
const NO_SIZES: Sizes = {};

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
  const { root } = useForm();
  const sizes = useStore((state) => state.catalogue?.sizes.solid) ?? NO_SIZES;
  const solid = definition(root, "SolidEntry").shape;
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
      {kind === "solid" && solid.kind === "record" ? (
        <RecordField
          shape={solid}
          value={body["solid"]}
          onChange={(next) => onChange({ ...body, solid: fitted(next, sizes) })}
          path={[...path, "solid"]}
          only={asked(Object.keys(solid.properties), mapAt(body, ["solid"]), sizes)}
        />
      ) : null}
      {kind === "solid" ? <InertiaFigures stated={{ solid: mapAt(body, ["solid"]) }} /> : null}
      <RecordField
        shape={shape}
        value={value}
        onChange={onChange}
        path={path}
        only={kind === "inertia" ? ["inertia"] : []}
      />
      {kind === "inertia" ? <InertiaFigures stated={{ inertia: mapAt(body, ["inertia"]) }} /> : null}
      <RecordField shape={shape} value={value} onChange={onChange} path={path} only={["waive"]} />
    </>
  );
}
