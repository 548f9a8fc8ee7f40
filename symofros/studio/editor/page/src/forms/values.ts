/** What is typed <-> what stands in the file. */

import type { Json } from "../api/types";

const NUMBER = /^[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?$/;

/** Whether a text is a number that can be held: 1e999 is left to the server, which says what is wrong with it. */
export const isNumber = (text: string): boolean => NUMBER.test(text.trim()) && Number.isFinite(Number(text));

/** A number if it is one, else the formula; undefined if nothing is there. */
export function typed(text: string): Json | undefined {
  const trimmed = text.trim();
  if (trimmed === "") return undefined;
  return isNumber(trimmed) ? Number(trimmed) : trimmed;
}

// Below this a number is shorter with an exponent.
const SMALL = 1e-3;

export function shown(value: Json | undefined): string {
  if (typeof value === "number" && value !== 0 && Math.abs(value) < SMALL) return value.toExponential();
  return value === undefined || value === null ? "" : typeof value === "object" ? JSON.stringify(value) : String(value);
}

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
  const quoted = trimmed.replace(/"[^"]*"|(?<![\w.])[A-Za-z_][\w.]*/g, (word) =>
    word.startsWith('"') || ["true", "false", "null"].includes(word) ? word : JSON.stringify(word),
  );
  try {
    return { value: JSON.parse(quoted.replace(/(^|[[,\s])([+-]?)\.(\d)/g, "$1$20.$3")) as Json };
  } catch {
    return undefined;
  }
}
