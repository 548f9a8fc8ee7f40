import { useState } from "react";

import { jointName } from "../model/names";
import { mapAt } from "../model/paths";
import { speeds } from "../model/joints";
import { Window } from "../shell/Window";
import { run } from "../store/jobs";
import { dismiss, useDocument, useStore } from "../store/store";

/** One-coordinate joints, whose start can be given as a number each; others start neutral and at rest. */
function starts(document: ReturnType<typeof useDocument>): string[] {
  return Object.entries(mapAt(document.data, ["bodies"]))
    .filter(([body]) => speeds(mapAt(document.data, ["bodies", body, "joint"])) === 1)
    .filter(([body]) => mapAt(document.data, ["bodies", body, "joint"])["kind"] !== "general")
    .map(([body]) => jointName(document.data, body));
}

type Numbers = Record<string, string>;

const numbers = (given: Numbers): Record<string, number> =>
  Object.fromEntries(Object.entries(given).flatMap(([name, text]) => (text.trim() === "" || Number.isNaN(Number(text)) ? [] : [[name, Number(text)]])));

function Column({ title, names, given, onChange }: { title: string; names: string[]; given: Numbers; onChange(given: Numbers): void }) {
  return names.map((name) => (
    <td key={name}>
      <input className="number" value={given[name] ?? ""} placeholder="0" aria-label={`${title} of ${name}`} inputMode="decimal" onChange={(event) => onChange({ ...given, [name]: event.target.value })} />
    </td>
  ));
}

// What was asked last is what is likely to be asked next.
let last = { end: "5", step: "0.001", method: "rk4", q0: {} as Numbers, v0: {} as Numbers };

/** What to simulate: from where, how long, by which method. */
export function SimulateForm() {
  const document = useDocument();
  const methods = useStore((state) => state.catalogue?.methods)?.map(({ name }) => name) ?? [];
  const names = starts(document);
  const [asked, setAsked] = useState({ ...last, method: methods.includes(last.method) ? last.method : (methods[0] ?? "") });
  const set = (part: Partial<typeof last>): void => setAsked({ ...asked, ...part });
  const fine = Number(asked.end) > 0 && Number(asked.step) > 0;
  const start = (): void => {
    last = asked;
    dismiss();
    const { end, step, method, q0, v0 } = asked;
    void run("simulate", { t_end: Number(end), dt: Number(step), method, q0: numbers(q0), v0: numbers(v0) });
  };
  const number = (key: "end" | "step", title: string) => (
    <div className="row">
      <label className="row-label" htmlFor={key}>
        {title}
      </label>
      <div className="row-control">
        <input id={key} className="number" value={asked[key]} inputMode="decimal" aria-invalid={!(Number(asked[key]) > 0)} onChange={(event) => set({ [key]: event.target.value })} />
      </div>
      <span className="row-unit">s</span>
    </div>
  );
  return (
    <Window
      title="Simulate"
      onClose={dismiss}
      onSubmit={start}
      foot={
        <>
          <button type="button" onClick={dismiss}>
            Cancel
          </button>
          <button type="submit" className="primary" disabled={!fine}>
            Simulate
          </button>
        </>
      }
    >
      {number("end", "Duration")}
      {number("step", "Step")}
      <div className="row">
        <label className="row-label" htmlFor="method">
          Method
        </label>
        <div className="row-control">
          <select id="method" value={asked.method} onChange={(event) => set({ method: event.target.value })}>
            {methods.map((method) => (
              <option key={method}>{method}</option>
            ))}
          </select>
        </div>
      </div>
      {names.length === 0 ? null : (
        <div className="scroll">
          <table className="starts">
            <thead>
              <tr>
                <td />
                {names.map((name) => (
                  <th key={name} scope="col">
                    {name}
                  </th>
                ))}
              </tr>
            </thead>
            <tbody>
              <tr>
                <th scope="row">Start</th>
                <Column title="Start" names={names} given={asked.q0} onChange={(q0) => set({ q0 })} />
              </tr>
              <tr>
                <th scope="row">Speed</th>
                <Column title="Speed" names={names} given={asked.v0} onChange={(v0) => set({ v0 })} />
              </tr>
            </tbody>
          </table>
        </div>
      )}
    </Window>
  );
}
