import type { Ran, RunCurve, RunPlot } from "../api/jobs";
import { brief } from "../model/plot";
import { type KeptRun, overlaid } from "../model/runs";
import { type Live, useStore } from "../store/store";
import { Beams } from "./Beams";
import { PlayBar } from "./PlayBar";
import { Plot, type PlotCurve } from "./Plot";
import { Runs } from "./Runs";

type Values = (curve: RunCurve) => readonly (number | null)[];

/** The second entry of each signal over its first. */
function inPlane(curves: readonly RunCurve[], values: Values): PlotCurve[] {
  const signals = [...new Set(curves.map(({ signal }) => signal))];
  return signals.flatMap((signal) => {
    const [x, y] = curves.filter((curve) => curve.signal === signal);
    return x === undefined || y === undefined ? [] : [{ name: signal, x: values(x), y: values(y) }];
  });
}

/** Curves of an earlier run beside those of a plot. */
const beside = (curves: readonly PlotCurve[], run: KeptRun, past: readonly PlotCurve[]): PlotCurve[] =>
  past
    .filter(({ name }) => curves.some((curve) => curve.name === name))
    .map((curve) => ({ ...curve, name: `${curve.name}, ${run.name}`, beside: curve.name }));

const drawn = (plot: RunPlot, t: readonly number[], values: Values): PlotCurve[] =>
  plot.xy ? inPlane(plot.curves, values) : plot.curves.map((curve) => ({ name: curve.name, x: t, y: values(curve) }));

const valuesOf = (result: Ran): Values => {
  const known = new Map(
    result.plots.flatMap(({ curves }) => curves.map(({ name, values }) => [name, values] as const)),
  );
  return ({ name }) => known.get(name) ?? [];
};

interface OfPlot {
  plot: RunPlot;
  t: readonly number[];
  values: Values;
  others?: readonly KeptRun[];
}

function OnePlot({ plot, t, values, others = [] }: OfPlot) {
  const units = [...new Set(plot.curves.map(({ unit }) => unit))].filter(Boolean);
  const unit = units.map((each) => `[${each}]`).join(", ");
  const newest = drawn(plot, t, values);
  const past = others.flatMap((run) => {
    const result = run.result as Ran;
    return beside(newest, run, drawn(plot, result.t, valuesOf(result)));
  });
  const label = `${plot.title}: ${newest.map(({ name }) => name).join(", ")}${plot.xy ? " in a plane" : " over time"}`;
  const titles = plot.xy ? { xTitle: `x ${unit}`, unit: `y ${unit}` } : { xTitle: "t [s]", unit };
  return <Plot curves={[...newest, ...past]} label={label} title={plot.title} plane={plot.xy} {...titles} />;
}

/** The curves of a run that goes on. */
export function LiveRun({ live }: { live: Live }) {
  return (
    <div className="results">
      <div className="plots of-run">
        {live.plots.map((plot) => (
          <OnePlot key={plot.title} plot={plot} t={live.t} values={({ name }) => live.values[name] ?? []} />
        ))}
      </div>
    </div>
  );
}

/** What a diagram's run left. */
export function Run({ result }: { result: Ran }) {
  const { ok, t, reason, advice, notes } = result.outcome;
  const runs = useStore((state) => state.runs);
  const job = useStore((state) => state.jobs.run?.id);
  const others = overlaid(runs, "run", job);
  const [motion] = Object.values(result.motions);
  return (
    <div className="results">
      <p className="quiet">
        {result.mode}, {result.method}
        {result.steps > 0 ? `, ${result.steps} steps` : ""}, {brief(result.wall_s)} s of computing to t = {brief(t)} s
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
      {motion === undefined ? null : <PlayBar t={motion.t} />}
      <Runs kind="run" />
      <div className="plots of-run">
        {result.plots.map((plot, i) => (
          <OnePlot key={i} plot={plot} t={result.t} values={valuesOf(result)} others={others} />
        ))}
      </div>
    </div>
  );
}
