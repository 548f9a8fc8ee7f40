import { useState } from "react";

import { isNumber } from "../forms/values";
import { coordinates, inputs } from "../model/motion";
import { Foot } from "../shell/Foot";
import { Row } from "../shell/Row";
import { Window } from "../shell/Window";
import { run } from "../store/jobs";
import { dismiss, useDocument, useStore } from "../store/store";

type Texts = Record<string, string>;

// What was asked last is what is likely to be asked next.
let last = {
  end: "5",
  step: "0.001",
  tolerance: "1e-8",
  method: "rk4",
  q0: {} as Texts,
  v0: {} as Texts,
  inputs: {} as Texts,
};

const given = (texts: Texts): [string, string][] => Object.entries(texts).filter(([, text]) => text.trim() !== "");
const numbers = (texts: Texts): Record<string, number> =>
  Object.fromEntries(given(texts).map(([name, text]) => [name, Number(text)]));
const positive = (text: string): boolean => isNumber(text) && Number(text) > 0;

interface ColumnProps {
  title: string;
  texts: Texts;
  isRight(text: string): boolean;
  onChange(texts: Texts): void;
}

/** One row a name, one field a column. */
function Table({ head, names, columns }: { head: string; names: string[]; columns: ColumnProps[] }) {
  if (names.length === 0) return null;
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
        {names.map((name) => (
          <tr key={name}>
            <th scope="row">{name}</th>
            {columns.map(({ title, texts, isRight, onChange }) => {
              const text = texts[name] ?? "";
              return (
                <td key={title}>
                  <input
                    className="number"
                    value={text}
                    placeholder="0"
                    aria-label={`${title} of ${name}`}
                    aria-invalid={text.trim() !== "" && !isRight(text)}
                    spellCheck={false}
                    onChange={(event) => onChange({ ...texts, [name]: event.target.value })}
                  />
                </td>
              );
            })}
          </tr>
        ))}
      </tbody>
    </table>
  );
}

function NumberRow({
  title,
  unit,
  text,
  onChange,
}: {
  title: string;
  unit: string;
  text: string;
  onChange(text: string): void;
}) {
  return (
    <Row title={title} unit={unit}>
      {(id) => (
        <input
          id={id}
          className="number"
          value={text}
          aria-invalid={!positive(text)}
          onChange={(event) => onChange(event.target.value)}
        />
      )}
    </Row>
  );
}

/** What to simulate: from where, driven by what, how long, by which method. */
export function SimulateForm() {
  const { data } = useDocument();
  const methods = useStore((state) => state.catalogue?.methods) ?? [];
  const [asked, setAsked] = useState(last);
  const set = (part: Partial<typeof last>): void => setAsked({ ...asked, ...part });
  const isAdaptive = methods.find(({ name }) => name === asked.method)?.adaptive === true;
  const starts = [...given(asked.q0), ...given(asked.v0)];
  const isFine =
    positive(asked.end) &&
    positive(isAdaptive ? asked.tolerance : asked.step) &&
    starts.every(([, text]) => isNumber(text));
  const begin = (kind: "simulate" | "page"): void => {
    if (!isFine) return;
    last = asked;
    dismiss();
    const { end, step, tolerance, method, q0, v0 } = asked;
    const accuracy = isAdaptive ? { rtol: Number(tolerance) } : { dt: Number(step) };
    const driven = { t_end: Number(end), inputs: Object.fromEntries(given(asked.inputs)) };
    const more = kind === "simulate" ? driven : {}; // The page goes on and on, and has sliders.
    void run(kind, { method, ...accuracy, q0: numbers(q0), v0: numbers(v0), ...more });
  };
  return (
    <Window
      title="Simulate"
      onClose={dismiss}
      onSubmit={() => begin("simulate")}
      foot={
        <>
          <button
            type="button"
            disabled={!isFine}
            title="Compile to WebAssembly: then this page simulates by itself, without end, with sliders of inputs and parameters"
            onClick={() => begin("page")}
          >
            In this page
          </button>
          <Foot word="Simulate" disabled={!isFine} />
        </>
      }
    >
      <NumberRow title="Duration" unit="s" text={asked.end} onChange={(end) => set({ end })} />
      <Row title="Method">
        {(id) => (
          <select id={id} value={asked.method} onChange={(event) => set({ method: event.target.value })}>
            {methods.map(({ name, help }) => (
              <option key={name} value={name} title={help}>
                {name.replaceAll("_", " ")}
              </option>
            ))}
          </select>
        )}
      </Row>
      {isAdaptive ? (
        <NumberRow
          title="Tolerance"
          unit="relative"
          text={asked.tolerance}
          onChange={(tolerance) => set({ tolerance })}
        />
      ) : (
        <NumberRow title="Step" unit="s" text={asked.step} onChange={(step) => set({ step })} />
      )}
      <Table
        head="Coordinate"
        names={coordinates(data)}
        columns={[
          { title: "Start", texts: asked.q0, isRight: isNumber, onChange: (q0) => set({ q0 }) },
          { title: "Speed", texts: asked.v0, isRight: isNumber, onChange: (v0) => set({ v0 }) },
        ]}
      />
      <Table
        head="Input"
        names={inputs(data)}
        columns={[
          {
            title: "Formula of t",
            texts: asked.inputs,
            isRight: () => true,
            onChange: (texts) => set({ inputs: texts }),
          },
        ]}
      />
    </Window>
  );
}
