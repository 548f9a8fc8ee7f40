import type { Crosschecked as Result } from "../api/jobs";
import { brief } from "../model/plot";

/** What the engines say of the same model. */
export function Crosschecked({ result }: { result: Result }) {
  return (
    <div className="results">
      <p className={result.ok ? "good" : "bad"}>{result.ok ? "All engines agree" : "Engines disagree"}</p>
      <table className="figures">
        <thead>
          <tr>
            <th scope="col">Quantity</th>
            <th scope="col">Engine</th>
            <th scope="col">Worst error</th>
            <th scope="col">Tolerance</th>
            <th scope="col">Verdict</th>
          </tr>
        </thead>
        <tbody>
          {result.rows.map((row) => (
            <tr key={`${row.quantity} ${row.engine}`}>
              <th scope="row">{row.quantity.replaceAll("_", " ")}</th>
              <td className="word">{row.engine}</td>
              <td>{brief(row.worst)}</td>
              <td>{brief(row.tolerance)}</td>
              <td className={row.passed ? "word good" : "word bad"}>{row.passed ? "agrees" : "differs"}</td>
            </tr>
          ))}
        </tbody>
      </table>
      {result.unsupported.map(({ engine, quantity, reason }) => (
        <p key={`${engine} ${quantity}`} className="quiet">
          {engine} does not do {quantity}: {reason}
        </p>
      ))}
    </div>
  );
}
