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
