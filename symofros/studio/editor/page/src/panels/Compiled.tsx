import type { Compiled as Result } from "../api/jobs";
import { brief } from "../model/plot";
import { Table } from "./Table";

const COLUMNS = ["mul", "add", "div", "call", "total"] as const;
const TITLES = { mul: "×", add: "+ −", div: "÷", call: "calls", total: "total" };

/** Operations of each function of the generated C. */
export function Compiled({ result }: { result: Result }) {
  return (
    <div className="results">
      <p>
        nq {result.nq}, nv {result.nv}, constraints {result.nc}, inputs {result.nu}, parameters {result.npar}
        <span className="quiet">
          {" "}
          · generated in {brief(result.generate_s)} s, compiled in {brief(result.compile_s)} s
        </span>
      </p>
      <table className="figures">
        <caption className="quiet">Operations of a call</caption>
        <thead>
          <tr>
            <th scope="col">Function</th>
            {COLUMNS.map((key) => (
              <th key={key} scope="col">
                {TITLES[key]}
              </th>
            ))}
          </tr>
        </thead>
        <tbody>
          {Object.entries(result.operations).map(([name, count]) => (
            <tr key={name}>
              <th scope="row">{name.replaceAll("_", " ")}</th>
              {COLUMNS.map((key) => (
                <td key={key}>{count[key]}</td>
              ))}
            </tr>
          ))}
        </tbody>
      </table>
      {result.methods.rows.length === 0 ? null : <Table table={result.methods} />}
      {result.notes.map((note) => (
        <p key={note} className="quiet">
          {note}
        </p>
      ))}
    </div>
  );
}
