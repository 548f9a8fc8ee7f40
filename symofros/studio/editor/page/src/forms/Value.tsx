import { useState } from "react";

import type { Json } from "../api/types";
import { same } from "../model/paths";
import { type ControlProps, useForm } from "./context";
import { meant, written } from "./values";

interface Props extends ControlProps {
  fallback: Json | undefined;
}

/** Numbers, lists of them, words. */
export function ValueField({ value, onChange, path, label, help, fallback }: Props) {
  const { hint, type } = useForm();
  const [text, setText] = useState(written(value));
  const now = meant(text);
  return (
    <input
      value={now === undefined || same(now.value, value) ? text : written(value)}
      aria-label={label}
      aria-description={help}
      aria-invalid={now === undefined}
      placeholder={written(fallback)}
      spellCheck={false}
      onFocus={() => hint(help)}
      onChange={(event) => {
        setText(event.target.value);
        const next = meant(event.target.value);
        if (next === undefined) return;
        if (typeof next.value === "number") type(path, event.target.value);
        onChange(next.value);
      }}
    />
  );
}
