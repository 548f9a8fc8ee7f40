import type { Texts } from "../model/asked";

export interface NameRow {
  name: string;
  unit: string;
  /** Name and units in words. */
  title: string;
  /** What counts where nothing is given. */
  fallback?: string;
}

interface Column {
  title: string;
  /** Rows that have it. */
  names: readonly string[];
  texts: Texts;
  isRight(text: string): boolean;
  onChange(texts: Texts): void;
}

function Cell({ column, row }: { column: Column; row: NameRow }) {
  const { title, texts, isRight, onChange } = column;
  const text = texts[row.name] ?? "";
  return (
    <input
      className="number"
      value={text}
      placeholder={row.fallback ?? "0"}
      aria-label={`${title} of ${row.name}`}
      aria-invalid={text.trim() !== "" && !isRight(text)}
      title={row.title}
      spellCheck={false}
      onChange={(event) => onChange({ ...texts, [row.name]: event.target.value })}
    />
  );
}

/** One row a name, one field a column that has the name. */
export function NameTable({
  head,
  rows,
  columns,
}: {
  head: string;
  rows: readonly NameRow[];
  columns: readonly Column[];
}) {
  if (rows.length === 0) return null;
  return (
    <table className="starts">
      <thead>
        <tr>
          <th scope="col">{head}</th>
          {columns.map(({ title }) => (
            <th key={title} scope="col">
              {title}
            </th>
          ))}
        </tr>
      </thead>
      <tbody>
        {rows.map((row) => (
          <tr key={row.name}>
            <th scope="row">
              {row.name} {row.unit === "" ? null : <span className="quiet">[{row.unit}]</span>}
            </th>
            {columns.map((column) => (
              <td key={column.title}>{column.names.includes(row.name) ? <Cell column={column} row={row} /> : null}</td>
            ))}
          </tr>
        ))}
      </tbody>
    </table>
  );
}

/** What was typed for names that there are no more: it is not used, and said. */
export function LeftOut({ texts, forget }: { texts: readonly (readonly [string, string])[]; forget(): void }) {
  if (texts.length === 0) return null;
  return (
    <p className="left-out" role="status">
      Left out, because the model has no coordinate or input of these names now:{" "}
      {texts.map(([name, text]) => `${name} = ${text}`).join(", ")}.{" "}
      <button type="button" className="small" onClick={forget}>
        Forget them
      </button>
    </p>
  );
}
