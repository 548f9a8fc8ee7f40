import { useEffect, useState } from "react";

import { post } from "../api/client";
import type { InertiaFigures as Figures, JsonMap } from "../api/types";
import { brief } from "../model/plot";

const PAUSE = 200;

/** What the server says of the body as it is typed; nothing while it can't be read. */
function useFigures(stated: JsonMap): Figures | null {
  const question = JSON.stringify(stated);
  const [answer, setAnswer] = useState<{ question: string; figures: Figures | null } | null>(null);
  useEffect(() => {
    let wanted = true;
    const timer = window.setTimeout(() => {
      post<Figures>("api/inertia", JSON.parse(question))
        .catch(() => null)
        .then((figures) => wanted && setAnswer({ question, figures }));
    }, PAUSE);
    return () => {
      wanted = false;
      window.clearTimeout(timer);
    };
  }, [question]);
  return answer?.figures ?? null;
}

const listed = (values: readonly number[]): string => values.map(brief).join(", ");

/** Mass, mass centre and moments of what is typed, at the parameters' values. */
export function InertiaFigures({ stated }: { stated: JsonMap }) {
  const figures = useFigures(stated);
  const size = Math.max(...(figures?.moments ?? []).map(Math.abs));
  const isOblique = figures?.products.some((value) => Math.abs(value) > 1e-12 * size) ?? false;
  return (
    <div className="live-figures" role="status" aria-label="What the body has">
      {figures === null ? (
        <p>Mass and moments are shown once every field has a number.</p>
      ) : (
        <>
          <p>
            mass {brief(figures.mass)} kg · mass centre [{listed(figures.center_of_mass)}] m
          </p>
          <p>
            about it, along the body&apos;s axes: Ixx, Iyy, Izz {listed(figures.moments)} kg m²
            {isOblique ? ` · Ixy, Ixz, Iyz ${listed(figures.products)} kg m²` : ""}
          </p>
        </>
      )}
    </div>
  );
}
