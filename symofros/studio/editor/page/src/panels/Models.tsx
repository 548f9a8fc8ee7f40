import { useEffect, useState } from "react";

import type { Edit, JsonMap } from "../api/types";
import { mapAt, textAt } from "../model/paths";
import { modelFiles } from "../store/diagram";
import { edit } from "../store/edits";
import { enter } from "../store/files";
import { identity } from "../store/renamed";
import { show, useDocument } from "../store/store";
import { Cell } from "./Cell";

const MOST_FUNCTIONS = 8;
// Characters of a path that a choice shows in a pane of the usual width.
const CHOICE = 40;

/** How rich a model's beams are: as its file says, rigid, or some shape functions in each direction they have any. */
function Functions({ name, model }: { name: string; model: JsonMap }) {
  const value = model["functions"];
  const path = ["models", name, "functions"];
  const change = (text: string): void => {
    const edits: Edit[] =
      text === "" ? (value === undefined ? [] : [{ op: "remove", path }]) : [{ op: "set", path, value: Number(text) }];
    void edit(`change ${name}`, edits);
  };
  return (
    <select
      value={typeof value === "number" ? String(value) : ""}
      aria-label={`Shape functions of ${name}`}
      onChange={(event) => change(event.target.value)}
    >
      <option value="">as in the file</option>
      {Array.from({ length: MOST_FUNCTIONS + 1 }, (_, n) => (
        <option key={n} value={n}>
          {n === 0 ? "none: rigid" : n}
        </option>
      ))}
    </select>
  );
}

/** The models of a diagram: exchanging one exchanges it for every block that refers to it. */
export function Models() {
  const { data, path } = useDocument();
  const [files, setFiles] = useState<string[]>([]);
  useEffect(() => {
    let isWanted = true;
    void modelFiles().then((found) => isWanted && setFiles(found));
    return () => {
      isWanted = false;
    };
  }, [path]);
  const models = mapAt(data, ["models"]);
  return (
    <div className="pane">
      {Object.keys(models).map((name) => {
        const model = mapAt(models, [name]);
        const file = textAt(model, ["file"]) ?? "";
        return (
          <section key={identity(["models", name])} className="model-card" aria-label={`Model ${name}`}>
            <Cell
              value={name}
              label={`Name of ${name}`}
              commit={(to) => edit(`rename ${name}`, [{ op: "rename", path: ["models", name], to: to.trim() }])}
            />
            <label>
              Mechanism
              <select
                value={file}
                aria-label={`Mechanism of ${name}`}
                onChange={(event) =>
                  void edit(`change ${name}`, [
                    { op: "set", path: ["models", name, "file"], value: event.target.value },
                  ])
                }
              >
                {[...new Set([file, ...files])].map((each) => (
                  <option key={each}>{each}</option>
                ))}
              </select>
            </label>
            {file.length > CHOICE ? <p className="quiet model-path">{file}</p> : null}
            <label>
              Functions
              <Functions name={name} model={model} />
            </label>
            <div className="model-doors">
              <button type="button" className="small" onClick={() => void enter(file)}>
                Open its canvas
              </button>
              <button
                type="button"
                className="small"
                onClick={() => show({ kind: "properties", path: ["models", name] })}
              >
                Start, parameters…
              </button>
            </div>
          </section>
        );
      })}
      {Object.keys(models).length === 0 ? (
        <p className="quiet">No models yet: add one from the palette; blocks refer to it by its name.</p>
      ) : null}
    </div>
  );
}
