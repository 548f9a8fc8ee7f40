import type { ResultTable } from "../api/jobs";
import { offer } from "../files/choose";
import { brief } from "../model/plot";
import { csv } from "../model/table";

// More are not read from a screen; the file has all of them.
const MOST = 40;

const shown = (value: string | number | null): string =>
  value === null ? "not finite" : typeof value === "number" ? brief(value) : value;

/** A table of an analysis, with a file of all of it. */
export function Table({ table }: { table: ResultTable }) {
  const { caption, head, rows } = table;
  const cut = rows.length > MOST || head.length > MOST + 1;
  const save = (): void =>
    offer(new Blob([csv(head, rows)], { type: "text/csv" }), `${caption.replaceAll(/\W+/g, "_")}.csv`);
  return (
    <div className="result-table" tabIndex={0} role="region" aria-label={caption}>
      <table className="figures">
        <caption>
          {caption}{" "}
          <button type="button" className="small" aria-label={`${caption} as CSV`} onClick={save}>
            CSV
          </button>
          {cut ? <span className="quiet"> the first {MOST} are shown, the file has all</span> : null}
        </caption>
        <thead>
          <tr>
            {head.slice(0, MOST + 1).map((title, i) => (
              <th key={i} scope="col">
                {title}
              </th>
            ))}
          </tr>
        </thead>
        <tbody>
          {rows.slice(0, MOST).map(([name, ...values], i) => (
            <tr key={i}>
              <th scope="row">{name}</th>
              {values.slice(0, MOST).map((value, j) => (
                <td key={j} className={typeof value === "string" ? "word" : ""}>
                  {shown(value)}
                </td>
              ))}
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}
