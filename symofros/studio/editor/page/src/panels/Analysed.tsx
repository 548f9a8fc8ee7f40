import { useState } from "react";

import type { Analysed as Result } from "../api/jobs";
import { startTexts } from "../model/motion";
import { askedSimulation, keepSimulation, showSimulation } from "../store/asked";
import { importText } from "../store/files";
import { setTime, showMotion, shownMotion } from "../store/playing";
import { now, update, useDocument, useStore } from "../store/store";
import { Beams } from "./Beams";
import { PlayBar } from "./PlayBar";
import { Plot } from "./Plot";
import { Table } from "./Table";

/** Which motion is played, where there are several. */
function Motions({ motions }: { motions: Result["motions"] }) {
  const shape = useStore((state) => state.shape);
  const chosen = shownMotion(motions, shape);
  const t = motions[chosen]?.t ?? [];
  const names = Object.keys(motions);
  return (
    <>
      {names.length < 2 ? null : (
        <label className="motion-choice">
          Shown in 3-D{" "}
          <select
            value={chosen}
            onChange={(event) => {
              update({ shape: event.target.value });
              setTime(now().time ?? 0);
            }}
          >
            {names.map((name) => (
              <option key={name}>{name}</option>
            ))}
          </select>
        </label>
      )}
      {t.length > 1 ? <PlayBar t={t} /> : null}
    </>
  );
}

/** What can be done with a state that was found: it is shown in 3-D, or simulated from. */
function Found({ start }: { start: Record<string, number> }) {
  const { data } = useDocument();
  const simulate = (): void => {
    keepSimulation({ ...askedSimulation(), q0: startTexts(data, start) });
    showSimulation();
  };
  return (
    <p className="found">
      <button type="button" className="small" onClick={showMotion}>
        Show in 3-D
      </button>{" "}
      <button type="button" className="small" title="Simulate with this state as the start" onClick={simulate}>
        Simulate from here…
      </button>
    </p>
  );
}

// More plots than these are chosen from by name.
const FEW = 2;

/** Plots of which those that are ticked are drawn: of many signals the first. */
function Plots({ plots }: { plots: Result["plots"] }) {
  const [chosen, setChosen] = useState<readonly string[]>(() => plots.slice(0, FEW).map(({ title }) => title));
  const toggle = (title: string, isShown: boolean): void =>
    setChosen(isShown ? [...chosen, title] : chosen.filter((each) => each !== title));
  return (
    <>
      {plots.length <= FEW ? null : (
        <details className="signals">
          <summary>Signals</summary>
          {plots.map(({ title }) => (
            <label key={title}>
              <input
                type="checkbox"
                checked={chosen.includes(title)}
                onChange={({ target }) => toggle(title, target.checked)}
              />{" "}
              {title}
            </label>
          ))}
        </details>
      )}
      <div className="plots">
        {plots
          .filter(({ title }) => chosen.includes(title))
          .map((plot) => (
            <Plot
              key={plot.title}
              title={plot.title}
              label={`${plot.title}: ${plot.curves.map(({ name }) => name).join(", ")}`}
              curves={plot.curves}
              xTitle={plot.x_title}
              unit={plot.unit}
            />
          ))}
      </div>
    </>
  );
}

/** Result of an analysis. */
export function Analysed({ result }: { result: Result }) {
  const { title, notes, tables, plots, motions, start, model, beams } = result;
  return (
    <div className="results">
      <p>{title}</p>
      {notes.map((note) => (
        <p key={note} className="quiet">
          {note}
        </p>
      ))}
      {start === null ? null : <Found start={start} />}
      {model === null ? null : (
        <button type="button" className="small" onClick={() => void importText(model.name, model.text)}>
          Open the reduced model
        </button>
      )}
      <Motions motions={motions} />
      <Beams beams={beams} />
      {plots.length === 0 ? null : <Plots plots={plots} />}
      <div className="tables">
        {tables.map((table) => (
          <Table key={table.caption} table={table} />
        ))}
      </div>
    </div>
  );
}
