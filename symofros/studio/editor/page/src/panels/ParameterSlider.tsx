import { useState } from "react";

import type { Parameter } from "../api/types";
import { parameterChange } from "../model/parameters";
import { edit } from "../store/edits";
import { useDocument } from "../store/store";
import { move, shownView } from "../store/view";

/** Moves the 3-D view while it is dragged, and changes the document when it is let go. */
export function ParameterSlider({ parameter }: { parameter: Parameter }) {
  const { data } = useDocument();
  const [dragged, setDragged] = useState<number | null>(null);
  const value = parameter.number ?? 0;
  const reach = 2 * Math.abs(value) || 1;
  const finish = (): void => {
    if (dragged !== null && dragged !== value) {
      const edits = parameterChange(data, parameter.name, "value", Number(dragged.toPrecision(4)));
      void edit(`change ${parameter.name}`, edits);
    }
    setDragged(null);
  };
  return (
    <input
      type="range"
      min={value < 0 ? -reach : 0}
      max={value < 0 ? 0 : reach}
      step={reach / 200}
      value={dragged ?? value}
      aria-label={`${parameter.name}, slider`}
      title={String(dragged ?? value)}
      onChange={(event) => {
        const next = Number(event.target.value);
        setDragged(next);
        if (shownView()?.run_time.includes(parameter.name)) void move({ par: { [parameter.name]: next } });
      }}
      onPointerUp={finish}
      onKeyUp={finish}
      onBlur={finish}
    />
  );
}
