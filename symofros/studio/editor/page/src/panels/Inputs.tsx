import type { JsonMap } from "../api/types";
import { mapAt, textAt } from "../model/paths";
import { IconButton } from "../shell/IconButton";
import { addEntry, edit } from "../store/edits";
import { identity } from "../store/renamed";
import { useDocument } from "../store/store";
import { symbols } from "../model/names";
import { Cell } from "./Cell";

/** Named inputs, for formulas of efforts and loads. */
export function Inputs() {
  const { data, inputs: read } = useDocument();
  const fault = (name: string): string => read.find((each) => each.name === name)?.unit_fault ?? "";
  const inputs: JsonMap = mapAt(data, ["inputs"]);
  const add = (): void => {
    void addEntry("inputs", "u1", symbols, () => ({ unit: "N m" }));
  };
  return (
    <div className="pane parameters">
      <table>
        <thead>
          <tr>
            <th scope="col">Input</th>
            <th scope="col">Unit</th>
            <th scope="col">Description</th>
            <td />
          </tr>
        </thead>
        <tbody>
          {Object.keys(inputs).map((name) => (
            <tr key={identity(["inputs", name])}>
              <th scope="row">
                <Cell
                  value={name}
                  label={`Name of ${name}`}
                  commit={(to) => edit(`rename ${name}`, [{ op: "rename", path: ["inputs", name], to: to.trim() }])}
                />
              </th>
              {["unit", "description"].map((key) => (
                <td key={key}>
                  <Cell
                    value={textAt(inputs, [name, key]) ?? ""}
                    label={`${key} of ${name}`}
                    fault={key === "unit" ? fault(name) : ""}
                    commit={(text) => edit(`change ${name}`, [{ op: "set", path: ["inputs", name, key], value: text }])}
                  />
                </td>
              ))}
              <td className="narrow">
                <IconButton
                  glyph="close"
                  label={`Remove ${name}`}
                  onClick={() => void edit(`remove ${name}`, [{ op: "remove", path: ["inputs", name] }])}
                />
              </td>
            </tr>
          ))}
        </tbody>
      </table>
      <button type="button" className="small" onClick={add}>
        Add input
      </button>
    </div>
  );
}
