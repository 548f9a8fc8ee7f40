import { useEffect, useState } from "react";

import { post } from "../api/client";
import type { Curves, Json, JsonMap, Path } from "../api/types";
import { beamGroups, DIRECTIONS } from "../forms/beam";
import { useForm } from "../forms/context";
import { RecordField } from "../forms/Record";
import { definition, label } from "../forms/schema";
import { mapAt } from "../model/paths";
import { Curve } from "../panels/Curve";
import { BeamSection } from "./BeamSection";

/** Shape functions of one direction, drawn over the length. */
function Shapes({ beam, direction }: { beam: JsonMap; direction: string }) {
  const [curves, setCurves] = useState<Curves | null>(null);
  const modes = beam[direction];
  const question = JSON.stringify({
    family: beam["family"] ?? "spline",
    theory: beam["theory"] ?? "second_order",
    modes,
    direction,
    shapes: mapAt(beam, ["shapes"])[direction] ?? [],
  });
  useEffect(() => {
    let wanted = true;
    // While a number is typed it may be out of range; then the last drawing stays.
    post<Curves>("api/shapes", JSON.parse(question))
      .then((answer) => wanted && setCurves(answer))
      .catch(() => undefined);
    return () => {
      wanted = false;
    };
  }, [question]);
  if (curves === null || typeof modes !== "number") return null;
  return (
    <figure className="shapes">
      <Curve
        x={curves.xi}
        series={curves.curves.map(({ values }) => values)}
        width={190}
        height={72}
        label={`${modes} shape functions: ${label(direction)}`}
      />
      <figcaption>{label(direction)}, over x/L</figcaption>
    </figure>
  );
}

interface Props {
  value: JsonMap;
  onChange(value: Json | undefined): void;
  path: Path;
}

/** A beam: its section, how many shape functions a direction, what is kept. */
export function BeamForm({ value, onChange, path }: Props) {
  const { root } = useForm();
  const { shape } = definition(root, "BeamEntry");
  if (shape.kind !== "record") return null;
  const props = { shape, value, onChange, path };
  const groups = beamGroups(root, shape.properties, value["family"]);
  const drawn = DIRECTIONS.filter((direction) => typeof value[direction] === "number" && value[direction] > 0);
  return (
    <>
      <h3>Shape functions</h3>
      <div className="beside">
        <RecordField {...props} only={groups.shapeFunctions} />
        <div className="figures">
          {drawn.map((direction) => (
            <Shapes key={direction} beam={value} direction={direction} />
          ))}
          {drawn.length === 0 ? <p className="quiet">No shape functions: the beam is rigid.</p> : null}
        </div>
      </div>
      <h3>Section</h3>
      <BeamSection beam={value} onChange={onChange} path={path} properties={groups.section} others={groups.formulas} />
      <h3>Model</h3>
      <RecordField {...props} only={groups.model} />
    </>
  );
}
