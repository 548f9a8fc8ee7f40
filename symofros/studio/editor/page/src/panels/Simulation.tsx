import type { Series, Simulated } from "../api/jobs";
import { brief } from "../model/plot";
import { Plot } from "./Plot";

function OfUnit({ t, series, unit }: { t: number[]; series: Series[]; unit: string }) {
  return (
    <Plot
      curves={series.map(({ name, values }) => ({ name, x: t, y: values }))}
      label={`${series.map(({ name }) => name).join(", ")} over time`}
      xTitle="t [s]"
      unit={unit}
    />
  );
}

/** Results of a simulation: curves of one unit share a plot. */
export function Simulation({ result }: { result: Simulated }) {
  const energies = Object.entries(result.energy).map(([name, values]): Series => ({
    name,
    kind: "energy",
    unit: "J",
    values,
  }));
  const all = [...result.series, ...energies];
  const units = [...new Set(all.map((each) => each.unit))];
  const { ok, reason, advice } = result.outcome;
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
      <div className="plots">
        {units.map((unit) => (
          <OfUnit key={unit} t={result.t} series={all.filter((each) => each.unit === unit)} unit={unit} />
        ))}
      </div>
    </div>
  );
}
