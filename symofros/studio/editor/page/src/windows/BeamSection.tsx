import { useEffect, useState } from "react";

import { post } from "../api/client";
import type { BeamFigures, Json, JsonMap, Path } from "../api/types";
import { useForm } from "../forms/context";
import { RecordField } from "../forms/Record";
import { definition } from "../forms/schema";
import { isMap, mapAt } from "../model/paths";
import { bentBy, percent, rough } from "../model/bending";
import { brief } from "../model/plot";
import { asked, fitted } from "../model/sizes";
import { useDocument, useStore } from "../store/store";

const PAUSE = 200;
/** A strip of aluminium, to begin with. */
const STRIP: JsonMap = { shape: "rectangle", E: 70e9, G: 26e9, rho: 2700, y: 0.02, z: 0.005 };
const MOTIONS: Record<string, string> = {
  bend_y: "bending along y",
  bend_z: "bending along z",
  twist: "twist",
  stretch: "stretch",
};
const UNITS: Record<string, string> = {
  rhoA: "kg/m",
  EI_y: "N m²",
  EI_z: "N m²",
  GJ: "N m²",
  EA: "N",
  rhoJ: "kg m",
};

/** What the server says of the beam as it is typed; while it can't be read, what was said before. */
export function useFigures(beam: JsonMap): BeamFigures | null {
  const [figures, setFigures] = useState<BeamFigures | null>(null);
  const question = JSON.stringify({ beam });
  useEffect(() => {
    let wanted = true;
    const timer = window.setTimeout(() => {
      post<BeamFigures>("api/beam", JSON.parse(question))
        .then((answer) => wanted && setFigures(answer))
        .catch(() => undefined);
    }, PAUSE);
    return () => {
      wanted = false;
      window.clearTimeout(timer);
    };
  }, [question]);
  return figures;
}

/** Frequencies, how far its theory reaches and, of a section by its shape, what it brings. */
function Figures({ beam, name, figures }: { beam: JsonMap; name: string; figures: BeamFigures | null }) {
  const { revision } = useDocument();
  const bent = bentBy(
    useStore((state) => state.jobs.simulate),
    revision,
  ).get(name);
  if (figures === null) return null;
  const properties = isMap(beam["section"]) ? Object.entries(figures.section).filter(([, value]) => value !== 0) : [];
  const frequencies = Object.entries(figures.frequencies);
  return (
    <div className="live-figures" role="status" aria-label="What the section brings">
      {properties.length === 0 ? null : (
        <p>{properties.map(([name, value]) => `${name} ${brief(value)} ${UNITS[name] ?? ""}`).join(" · ")}</p>
      )}
      {frequencies.length === 0 ? null : (
        <p>
          Clamped at its root, free at its tip [Hz]:{" "}
          {frequencies.map(([name, values]) => `${MOTIONS[name] ?? name} ${values.map(brief).join(", ")}`).join(" · ")}
        </p>
      )}
      {figures.validity.length === 0 ? null : (
        <p>
          Its theory errs by{" "}
          {figures.validity
            .map(({ error, deflection, slope }) => `${percent(error)} at ${rough(deflection)} m (${rough(slope)} rad)`)
            .join(", ")}{" "}
          of the tip, under a force there.
        </p>
      )}
      {bent === undefined ? null : (
        <p className={bent.grade === "beyond" ? "bad" : ""}>
          In the newest simulation {bent.text}
          {bent.grade === "fine" ? "" : `; ${bent.remedy}`}.
        </p>
      )}
    </div>
  );
}

interface Props {
  beam: JsonMap;
  onChange(value: Json | undefined): void;
  path: Path;
  /** Properties of the beam that a section by its shape takes the place of. */
  properties: readonly string[];
  /** Formulas of the beam that it does not. */
  others: readonly string[];
  figures: BeamFigures | null;
}

/** The section: by its properties per length, or by material and shape; with the frequencies that follow. */
export function BeamSection({ beam, onChange, path, properties, others, figures }: Props) {
  const { root } = useForm();
  const catalogue = useStore((state) => state.catalogue);
  const { shape } = definition(root, "BeamEntry");
  const ofSection = definition(root, "SectionEntry").shape;
  if (shape.kind !== "record" || ofSection.kind !== "record") return null;
  const sizes = catalogue?.sizes.section ?? {};
  const byShape = isMap(beam["section"]);
  const choose = (shaped: boolean): void => {
    const kept = Object.entries(beam).filter(([key]) => key !== "section" && !properties.includes(key));
    onChange({ ...Object.fromEntries(kept), ...(shaped ? { section: STRIP } : { rhoA: 1, EI_y: 100, EI_z: 100 }) });
  };
  return (
    <>
      <div className="row">
        <label className="row-label" htmlFor="section-by">
          Stated by
        </label>
        <div className="row-control">
          <select
            id="section-by"
            value={byShape ? "shape" : "properties"}
            onChange={(event) => choose(event.target.value === "shape")}
          >
            <option value="properties">stiffness and mass per length</option>
            <option value="shape">material and shape</option>
          </select>
        </div>
      </div>
      <RecordField shape={shape} value={beam} onChange={onChange} path={path} only={others} />
      {byShape ? (
        <RecordField
          shape={ofSection}
          value={beam["section"]}
          onChange={(section) => onChange({ ...beam, section: fitted(section, sizes) })}
          path={[...path, "section"]}
          only={asked(Object.keys(ofSection.properties), mapAt(beam, ["section"]), sizes)}
        />
      ) : (
        <RecordField shape={shape} value={beam} onChange={onChange} path={path} only={properties} />
      )}
      <Figures beam={beam} name={String(path[1] ?? "")} figures={figures} />
    </>
  );
}
