import { useEffect, useState } from "react";

import { post } from "../api/client";
import type { Curves, Json, JsonMap, Path } from "../api/types";
import { beamGroups, DIRECTIONS } from "../forms/beam";
import { useForm } from "../forms/context";
import { RecordField } from "../forms/Record";
import { definition, label } from "../forms/schema";
import { mapAt } from "../model/paths";
import { Curve } from "../panels/Curve";
import { useDocument } from "../store/store";
import { Row } from "../shell/Row";
import { BeamPicture } from "./BeamPicture";
import { BeamSection, useFigures } from "./BeamSection";

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

/** What a beam has in most models: the window shows the rest where the file states it, or where it is asked for. */
const BASIC = ["length", "bend_y", "bend_z", "twist", "rhoA", "EI_y", "EI_z", "GJ", "rhoJ", "damping", "section"];
const PLANES: Record<string, string> = { bend_y: "bending along y", bend_z: "bending along z" };

/** A beam: its section, how many shape functions a direction, what is kept; first what most beams have. */
export function BeamForm({ value, onChange, path }: Props) {
  const { root } = useForm();
  const [isWhole, setWhole] = useState(false);
  const figures = useFigures(value);
  const { problems } = useDocument();
  const { shape } = definition(root, "BeamEntry");
  if (shape.kind !== "record") return null;
  const props = { shape, value, onChange, path };
  const all = beamGroups(root, shape.properties, value["family"]);
  // What something is wrong with is not hidden, though it may be left out.
  const isWrong = (name: string): boolean =>
    problems.some((each) => [...path, name].every((key, i) => key === each.path[i]));
  const isShown = (name: string): boolean => isWhole || BASIC.includes(name) || name in value || isWrong(name);
  const groups = {
    shapeFunctions: all.shapeFunctions.filter(isShown),
    section: all.section.filter(isShown),
    formulas: all.formulas.filter(isShown),
    model: all.model.filter(isShown),
  };
  const drawn = DIRECTIONS.filter((direction) => typeof value[direction] === "number" && value[direction] > 0);
  return (
    <>
      <Row title="Shown">
        {(id) => (
          <select
            id={id}
            value={isWhole ? "all" : "basic"}
            onChange={(event) => setWhole(event.target.value === "all")}
          >
            <option value="basic">basic, and what the file states</option>
            <option value="all">all</option>
          </select>
        )}
      </Row>
      <div className="figures beam-pictures">
        {Object.entries(figures?.frequencies ?? {}).map(([direction, frequencies]) =>
          PLANES[direction] === undefined ? null : (
            <BeamPicture
              key={direction}
              length={typeof value["length"] === "number" ? `${value["length"]} m` : String(value["length"] ?? "")}
              frequencies={frequencies}
              motion={PLANES[direction]}
            />
          ),
        )}
      </div>
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
      <BeamSection
        beam={value}
        onChange={onChange}
        path={path}
        properties={groups.section}
        others={groups.formulas}
        figures={figures}
      />
      {groups.model.length === 0 ? null : <h3>Model</h3>}
      <RecordField {...props} only={groups.model} />
    </>
  );
}
