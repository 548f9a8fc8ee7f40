import { useState } from "react";

import { post } from "../api/client";
import type { Edit, Json, Parameter } from "../api/types";
import { shown, typed } from "../forms/values";
import { asTyped, keyOf } from "../model/changes";
import { fresh, symbols } from "../model/names";
import { at, isMap } from "../model/paths";
import { IconButton } from "../shell/IconButton";
import { edit } from "../store/edits";
import { useDocument, useStore } from "../store/store";
import { Cell } from "./Cell";

const UNITS = "units";

/** An entry may be a number alone; then what else is said of it makes it a mapping. */
function change(data: Json, name: string, key: string, value: Json | undefined): Edit[] {
  const path = ["parameters", name];
  const entry = at(data, path);
  if (!isMap(entry))
    return [{ op: "set", path, value: key === "value" ? (value ?? 0) : { value: entry ?? 0, [key]: value ?? "" } }];
  if (value === undefined) return key in entry ? [{ op: "remove", path: [...path, key] }] : [];
  return [{ op: "set", path: [...path, key], value }];
}

/** Moves the 3-D view while it is dragged, and changes the document when it is let go. */
function Slider({ parameter, commit }: { parameter: Parameter; commit(value: number): void }) {
  const hasView = useStore((state) => typeof state.catalogue?.view === "string");
  const [dragged, setDragged] = useState<number | null>(null);
  const value = parameter.number ?? 0;
  const reach = 2 * Math.abs(value) || 1;
  const finish = (): void => {
    if (dragged !== null && dragged !== value) commit(Number(dragged.toPrecision(4)));
    setDragged(null);
  };
  return (
    <input
      type="range"
      min={value < 0 ? -reach : 0}
      max={value < 0 ? 0 : reach}
      step={reach / 200}
      value={dragged ?? value}
      aria-label={`${parameter.name}, slider`}
      title={String(dragged ?? value)}
      onChange={(event) => {
        const next = Number(event.target.value);
        setDragged(next);
        // A pose that comes too late, or not at all, is replaced by the next.
        if (hasView) post("api/pose", { par: { [parameter.name]: next } }).catch(() => undefined);
      }}
      onPointerUp={finish}
      onKeyUp={finish}
      onBlur={finish}
    />
  );
}

function Row({ parameter }: { parameter: Parameter }) {
  const { data } = useDocument();
  const { name } = parameter;
  const set = (key: string, value: Json | undefined): void =>
    void edit(`change ${name}`, change(data, name, key, value));
  const setNumber = (text: string): void => {
    const edits = change(data, name, "value", typed(text) ?? 0);
    void edit(
      `change ${name}`,
      edits.map((each) => asTyped(each, new Map([[keyOf(each.path), text.trim()]]))),
    );
  };
  return (
    <tr>
      <th scope="row">
        <Cell
          value={name}
          label={`Name of ${name}`}
          commit={(to) => void edit(`rename ${name}`, [{ op: "rename", path: ["parameters", name], to: to.trim() }])}
        />
      </th>
      <td>
        <Cell value={shown(parameter.value)} label={`Value of ${name}`} numeric commit={setNumber} />
      </td>
      <td>
        <Cell
          value={parameter.unit}
          label={`Unit of ${name}`}
          list={UNITS}
          commit={(text) => set("unit", text === "" ? undefined : text)}
        />
      </td>
      <td className="narrow">
        <input
          type="checkbox"
          checked={parameter.constant}
          aria-label={`${name} is constant`}
          title="hard-coded in the C code"
          onChange={(event) => set("constant", event.target.checked ? true : undefined)}
        />
      </td>
      <td>
        <Slider parameter={parameter} commit={(value) => set("value", value)} />
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
}

/** Names and their numbers: given at run time, or hard-coded. */
export function Parameters() {
  const { parameters, data } = useDocument();
  const units = useStore((state) => state.catalogue?.units) ?? [];
  const add = (): void => {
    const name = fresh("p1", symbols(data));
    void edit(`add ${name}`, [{ op: "set", path: ["parameters", name], value: { value: 1 } }]);
  };
  return (
    <div className="pane parameters">
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
          {parameters.map((parameter) => (
            <Row key={parameter.name} parameter={parameter} />
          ))}
        </tbody>
      </table>
      {parameters.length === 0 ? <p className="quiet">No parameters yet. A name in a formula must be one.</p> : null}
      <button type="button" className="small" onClick={add}>
        Add parameter
      </button>
    </div>
  );
}
