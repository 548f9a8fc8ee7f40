import { useState } from "react";

import type { Json } from "../api/types";
import { same } from "../model/paths";
import { type ControlProps, useForm } from "./context";
import { isNumber, shown } from "./values";

/** A value as one writes it in the file: 4, [600, 250, 40], [[1, 0], [0, 1]], a word. */
export function written(value: Json | undefined): string {
  if (Array.isArray(value)) return `[${value.map(written).join(", ")}]`;
  return shown(value);
}

/** What is meant by a text; undefined if it is neither a value nor nothing. */
export function meant(text: string): { value: Json | undefined } | undefined {
  const trimmed = text.trim();
  if (trimmed === "") return { value: undefined };
  if (isNumber(trimmed)) return { value: Number(trimmed) };
  if (trimmed === "true" || trimmed === "false") return { value: trimmed === "true" };
  if (!/^[[{]/.test(trimmed)) return { value: trimmed };
  // Words go without quotes in the file; JSON wants them.
  const quoted = trimmed.replace(/"[^"]*"|[A-Za-z_][\w.]*(?![\w.]*e?[+-]?\d)/g, (word) =>
    word.startsWith('"') || ["true", "false", "null"].includes(word) ? word : JSON.stringify(word),
  );
  try {
    return { value: JSON.parse(quoted.replace(/(^|[[,\s])([+-]?)\.(\d)/g, "$1$20.$3")) as Json };
  } catch {
    return undefined;
  }
}

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
