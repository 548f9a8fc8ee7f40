import type { Parameter } from "../api/types";
import { parameterChange } from "../model/parameters";
import { edit } from "../store/edits";
import { useDocument } from "../store/store";
import { move, shownView } from "../store/view";
import { useUnsent } from "./useUnsent";

/** Moves the 3-D view while it is dragged, and changes the document when it is let go. */
export function ParameterSlider({ parameter }: { parameter: Parameter }) {
  const { data } = useDocument();
  const value = parameter.number ?? 0;
  const commit = (to: number): Promise<boolean> =>
    edit(`change ${parameter.name}`, parameterChange(data, parameter.name, "value", Number(to.toPrecision(4))));
  const { typed: dragged, type: drag, send: finish } = useUnsent(value, commit);
  const reach = 2 * Math.abs(value) || 1;
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
        drag(next);
        if (shownView()?.run_time.includes(parameter.name)) void move({ par: { [parameter.name]: next } });
      }}
      onPointerUp={() => void finish()}
      onKeyUp={() => void finish()}
      onBlur={() => void finish()}
    />
  );
}
