import { useState } from "react";

import type { Json } from "../api/types";
import { same } from "../model/paths";
import { useForm } from "./context";
import { shown } from "./values";

interface Props {
  value: Json | undefined;
  onChange(value: Json | undefined): void;
  label: string;
  help: string;
  fallback: Json | undefined;
}

/** Words, of several lines where they may be long. */
export function TextField({ value, onChange, label, help, fallback, isLong = false }: Props & { isLong?: boolean }) {
  const { hint } = useForm();
  const Control = isLong ? "textarea" : "input";
  return (
    <Control
      value={shown(value)}
      rows={isLong ? 4 : undefined}
      aria-label={label}
      aria-description={help}
      placeholder={shown(fallback)}
      spellCheck={isLong}
      onFocus={() => hint(help)}
      onChange={(event) => onChange(event.target.value === "" ? undefined : event.target.value)}
    />
  );
}

/** A plain number; empty means: left out. */
export function NumberField({
  value,
  onChange,
  label,
  help,
  fallback,
  integer,
  minimum,
  maximum,
}: Props & { integer: boolean; minimum: number | null; maximum: number | null }) {
  const { hint } = useForm();
  const [text, setText] = useState(shown(value));
  const parse = (each: string): Json | undefined =>
    each.trim() === "" || Number.isNaN(Number(each)) ? undefined : Number(each);
  return (
    <input
      className="number"
      type="number"
      value={same(parse(text), value) ? text : shown(value)}
      min={minimum ?? undefined}
      max={maximum ?? undefined}
      step={integer ? 1 : "any"}
      aria-label={label}
      aria-description={help}
      placeholder={shown(fallback)}
      onFocus={() => hint(help)}
      onChange={(event) => {
        setText(event.target.value);
        onChange(parse(event.target.value));
      }}
    />
  );
}

export function FlagField({ value, onChange, label, help, fallback }: Props) {
  const { hint } = useForm();
  return (
    <input
      type="checkbox"
      checked={(value ?? fallback) === true}
      aria-label={label}
      aria-description={help}
      onFocus={() => hint(help)}
      onChange={(event) => onChange(event.target.checked === fallback ? undefined : event.target.checked)}
    />
  );
}

export function ChoiceField({
  value,
  onChange,
  label,
  help,
  fallback,
  options,
}: Props & { options: readonly string[] }) {
  const { hint } = useForm();
  const current = typeof value === "string" ? value : shown(fallback);
  // What the file says is shown even if it is none of the choices; it has a complaint then.
  const all = options.includes(current) ? options : [current, ...options];
  return (
    <select
      value={current}
      aria-label={label}
      aria-description={help}
      onFocus={() => hint(help)}
      onChange={(event) => onChange(event.target.value === fallback ? undefined : event.target.value)}
    >
      {all.map((option) => (
        <option key={option} value={option}>
          {option === "" ? "-" : option.replaceAll("_", " ")}
        </option>
      ))}
    </select>
  );
}

/** Any of a few words. None is not the same as left out, where leaving out means something else. */
export function SetField({ value, onChange, label, help, fallback, options }: Props & { options: readonly string[] }) {
  const { hint } = useForm();
  const present = Array.isArray(value) ? value : label === "Translations" ? options : [];
  return (
    <div className="choices" role="group" aria-label={label}>
      {options.map((option) => (
        <label key={option} className="choice">
          <input
            type="checkbox"
            checked={present.includes(option)}
            aria-description={help}
            onFocus={() => hint(help)}
            onChange={(event) => {
              const next = options.filter((each) => (each === option ? event.target.checked : present.includes(each)));
              onChange(next.length === 0 && Array.isArray(fallback) ? undefined : [...next]);
            }}
          />
          {option.replaceAll("_", " ")}
        </label>
      ))}
    </div>
  );
}
