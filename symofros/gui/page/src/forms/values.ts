/** What is typed <-> what stands in the file. */

import type { Json } from "../api/types";

const NUMBER = /^[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?$/;

export const isNumber = (text: string): boolean => NUMBER.test(text.trim());

/** A number if it is one, else the formula; undefined if nothing is there. */
export function typed(text: string): Json | undefined {
  const trimmed = text.trim();
  if (trimmed === "") return undefined;
  return isNumber(trimmed) ? Number(trimmed) : trimmed;
}

export function shown(value: Json | undefined): string {
  return value === undefined || value === null ? "" : typeof value === "object" ? JSON.stringify(value) : String(value);
}
