import { useState } from "react";

import type { Json, Parameter } from "../api/types";
import { shown, typed } from "../forms/values";
import { asTyped, keyOf } from "../model/changes";
import { parameterChange } from "../model/parameters";
import { symbols } from "../model/names";
import { IconButton } from "../shell/IconButton";
import { addEntry, edit } from "../store/edits";
import { identity } from "../store/renamed";
import { update, useDocument, useStore } from "../store/store";
import { Cell } from "./Cell";
import { ParameterSlider } from "./ParameterSlider";

const UNITS = "units";
/** Of so many there is a field that finds one. */
const FEW = 12;
/** Names of more letters stand above what belongs to them: their column is no wider. */
const LONG = 10;
/** Rows that are drawn at once: hundreds of sliders make each edit of a large model wait. */
const PAGE = 50;

function Row({ parameter }: { parameter: Parameter }) {
  const { data } = useDocument();
  const { name } = parameter;
  const set = (key: string, value: Json | undefined): Promise<boolean> =>
    edit(`change ${name}`, parameterChange(data, name, key, value));
  const setNumber = (text: string): Promise<boolean> => {
    const edits = parameterChange(data, name, "value", typed(text) ?? 0);
    return edit(
      `change ${name}`,
      edits.map((each) => asTyped(each, new Map([[keyOf(each.path), text.trim()]]))),
    );
  };
  const isLong = name.length > LONG;
  const head = (
    <th scope="row" colSpan={isLong ? 6 : 1}>
      <Cell
        value={name}
        label={`Name of ${name}`}
        commit={(to) => edit(`rename ${name}`, [{ op: "rename", path: ["parameters", name], to: to.trim() }])}
      />
    </th>
  );
  const row = (
    <tr>
      {isLong ? <td /> : head}
      <td>
        <Cell value={shown(parameter.value)} label={`Value of ${name}`} numeric commit={setNumber} />
      </td>
      <td>
        <Cell
          value={parameter.unit}
          label={`Unit of ${name}`}
          list={UNITS}
          fault={parameter.unit_fault}
          commit={(text) => set("unit", text === "" ? undefined : text)}
        />
      </td>
      <td className="narrow">
        <input
          type="checkbox"
          checked={parameter.constant}
          aria-label={`${name} is constant`}
          title="hard-coded in the C code"
          onChange={(event) => void set("constant", event.target.checked ? true : undefined)}
        />
      </td>
      <td>
        <ParameterSlider parameter={parameter} />
      </td>
      <td className="narrow">
        <IconButton
          glyph="close"
          label={`Remove ${name}`}
          onClick={() => void edit(`remove ${name}`, [{ op: "remove", path: ["parameters", name] }])}
        />
      </td>
    </tr>
  );
  return isLong ? (
    <>
      <tr>{head}</tr>
      {row}
    </>
  ) : (
    row
  );
}

/** Names and their numbers: given at run time, or hard-coded. */
export function Parameters() {
  const { parameters } = useDocument();
  const units = useStore((state) => state.catalogue?.units) ?? [];
  const filter = useStore((state) => state.filter);
  const [most, setMost] = useState(PAGE);
  const named = parameters.filter(({ name }) => name.toLowerCase().includes(filter.trim().toLowerCase()));
  const left = named.length - most;
  const add = (): void => {
    update({ filter: "" });
    void addEntry("parameters", "p1", symbols, () => ({ value: 1 }));
  };
  return (
    <div className="pane parameters">
      {parameters.length <= FEW && filter === "" ? null : (
        <input
          type="search"
          value={filter}
          placeholder={`Find one of ${parameters.length} parameters`}
          aria-label="Find a parameter"
          spellCheck={false}
          onChange={(event) => update({ filter: event.target.value })}
        />
      )}
      <datalist id={UNITS}>
        {units.map((unit) => (
          <option key={unit} value={unit} />
        ))}
      </datalist>
      <table>
        <thead>
          <tr>
            <th scope="col">Parameter</th>
            <th scope="col">Value</th>
            <th scope="col">Unit</th>
            <th scope="col" title="hard-coded in the C code, not given at run time">
              Const
            </th>
            <th scope="col">Range</th>
            <td />
          </tr>
        </thead>
        <tbody>
          {named.slice(0, most).map((parameter) => (
            <Row key={identity(["parameters", parameter.name])} parameter={parameter} />
          ))}
        </tbody>
      </table>
      {parameters.length === 0 ? <p className="quiet">No parameters yet. A name in a formula must be one.</p> : null}
      {left <= 0 ? null : (
        <button type="button" className="small" onClick={() => setMost(most + PAGE)}>
          Show {Math.min(PAGE, left)} of {left} more
        </button>
      )}
      <button type="button" className="small" onClick={add}>
        Add parameter
      </button>
    </div>
  );
}
