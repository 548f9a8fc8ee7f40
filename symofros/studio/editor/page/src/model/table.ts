/** Tables as files. */

type Value = string | number | null;

const cell = (value: Value): string =>
  value === null
    ? ""
    : typeof value === "number"
      ? String(value)
      : /[",\n]/.test(value)
        ? `"${value.replaceAll('"', '""')}"`
        : value;

/** A table as CSV with all digits; empty where a number is not finite. */
export const csv = (head: readonly string[], rows: readonly (readonly Value[])[]): string =>
  [head, ...rows].map((row) => `${row.map(cell).join(",")}\n`).join("");
