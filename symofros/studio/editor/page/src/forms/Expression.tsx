import { useId, useState } from "react";

import type { Checked, Json } from "../api/types";
import { mapAt, same } from "../model/paths";
import { setValue } from "../store/edits";
import { useStore } from "../store/store";
import { type ControlProps, useForm } from "./context";
import { useChecked } from "./useChecked";
import { shown, typed } from "./values";

interface ExpressionProps extends ControlProps {
  fallback?: Json | undefined;
  required?: boolean;
}

const UNKNOWN = /unknown symbol '([A-Za-z_][A-Za-z_0-9]*)'/;

/** A name that the formula uses and nobody gives, if the fault is that. */
function missing(checked: Checked): string | null {
  return UNKNOWN.exec(checked.error?.found ?? "")?.[1] ?? null;
}

function Complaint({ id, checked }: { id: string; checked: Checked }) {
  const name = missing(checked);
  return (
    <div id={id} className="complaint" role="alert">
      <span>{checked.error?.found}</span>
      {checked.error?.remedy ? <span className="remedy">{checked.error.remedy}</span> : null}
      {name === null ? null : (
        <>
          <button
            type="button"
            className="small"
            onClick={() => void setValue(`add ${name}`, ["parameters", name], { value: 1 })}
          >
            Add parameter {name}
          </button>
          <button type="button" className="small" onClick={() => void setValue(`add ${name}`, ["inputs", name], {})}>
            Add input {name}
          </button>
        </>
      )}
    </div>
  );
}

/** One formula, checked by the server while it is typed. */
export function Expression({ value, onChange, path, label, help, fallback, required = false }: ExpressionProps) {
  const id = useId();
  const { hint, type } = useForm();
  const [text, setText] = useState(shown(value));
  const current = same(typed(text), value) ? text : shown(value);
  // A name that was just added makes a formula right: what is known is part of the question.
  const known = useStore(
    (state) =>
      (state.document?.parameters.length ?? 0) + Object.keys(mapAt(state.document?.data ?? {}, ["inputs"])).length,
  );
  const checked = useChecked([...path], current + " ".repeat(known % 2));
  const wrong = checked?.ok === false;
  const number = checked?.ok === true && typeof checked.value === "number" ? checked.value : null;
  return (
    <div className={`expression${wrong ? " wrong" : ""}`}>
      <input
        value={current}
        aria-label={label}
        aria-description={help}
        aria-invalid={wrong}
        aria-errormessage={wrong ? id : undefined}
        placeholder={shown(fallback)}
        required={required}
        spellCheck={false}
        autoComplete="off"
        title={number === null ? help : `= ${number}`}
        onFocus={() => hint(help)}
        onChange={(event) => {
          setText(event.target.value);
          type(path, event.target.value);
          onChange(typed(event.target.value));
        }}
      />
      {wrong ? <Complaint id={id} checked={checked} /> : null}
    </div>
  );
}
