import type { Series, Simulated } from "../api/jobs";
import { brief } from "../model/plot";
import { overlaid } from "../model/runs";
import { useStore } from "../store/store";
import { Beams } from "./Beams";
import { PlayBar } from "./PlayBar";
import { Plot, type PlotCurve } from "./Plot";
import { Runs } from "./Runs";
import { Table } from "./Table";

/** All curves of a simulation, energies too. */
function allSeries(result: Simulated): Series[] {
  const energies = Object.entries(result.energy).map(([name, values]): Series => ({
    name,
    kind: "energy",
    unit: "J",
    values,
  }));
  return [...result.series, ...energies];
}

function OfUnit({ t, series, unit, others }: { t: number[]; series: Series[]; unit: string; others: PlotCurve[] }) {
  return (
    <Plot
      curves={[...series.map(({ name, values }) => ({ name, x: t, y: values })), ...others]}
      label={`${series.map(({ name }) => name).join(", ")} over time`}
      xTitle="t [s]"
      unit={unit}
    />
  );
}

/** Results of a simulation: curves of one unit share a plot. */
export function Simulation({ result }: { result: Simulated }) {
  const runs = useStore((state) => state.runs);
  const newest = useStore((state) => state.jobs.simulate?.id);
  const all = allSeries(result);
  const others = (unit: string): PlotCurve[] =>
    overlaid(runs, "simulate", newest).flatMap((run) => {
      const past = run.result as Simulated;
      return allSeries(past)
        .filter((each) => each.unit === unit && all.some(({ name }) => name === each.name))
        .map(({ name, values }) => ({ name: `${name}, ${run.name}`, x: past.t, y: values, beside: name }));
    });
  const units = [...new Set(all.map((each) => each.unit))];
  const { ok, reason, advice, notes } = result.outcome;
  return (
    <div className="results">
      <p className="quiet">
        {result.method}, {result.steps} steps, {brief(result.wall_s)} s of computing
      </p>
      {ok ? null : (
        <p className="bad">
          {reason} {advice}
        </p>
      )}
      {notes.map((note) => (
        <p key={note} className="quiet">
          {note}
        </p>
      ))}
      <Beams beams={result.beams} />
      {result.events.rows.length === 0 ? null : <Table table={result.events} />}
      <PlayBar t={result.t} />
      <Runs kind="simulate" />
      <div className="plots">
        {units.map((unit) => (
          <OfUnit
            key={unit}
            t={result.t}
            series={all.filter((each) => each.unit === unit)}
            unit={unit}
            others={others(unit)}
          />
        ))}
      </div>
    </div>
  );
}
