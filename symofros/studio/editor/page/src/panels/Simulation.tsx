import { useState } from "react";

import type { Series, Simulated } from "../api/jobs";
import { brief, line, span, ticks } from "../model/plot";

const HEIGHT = 200;
const WIDTH = 640;
const BOX = { x: 56, y: 8, width: WIDTH - 64, height: HEIGHT - 34 };

/** Curves over time, with scales, and the values under the pointer. */
function Plot({ t, series, unit }: { t: number[]; series: Series[]; unit: string }) {
  const [cursor, setCursor] = useState<number | null>(null);
  const xs = span(t);
  const ys = span(series.flatMap((each) => each.values));
  const x = (value: number): number => BOX.x + (BOX.width * (value - xs[0])) / (xs[1] - xs[0]);
  const y = (value: number): number => BOX.y + BOX.height * (1 - (value - ys[0]) / (ys[1] - ys[0]));
  const time = cursor === null ? undefined : t[cursor];
  const follow = (event: React.PointerEvent<SVGSVGElement>): void => {
    const frame = event.currentTarget.getBoundingClientRect();
    const share = (((event.clientX - frame.left) / frame.width) * WIDTH - BOX.x) / BOX.width;
    setCursor(share < 0 || share > 1 ? null : Math.round(share * (t.length - 1)));
  };
  return (
    <figure className="plot">
      <svg
        viewBox={`0 0 ${WIDTH} ${HEIGHT}`}
        role="img"
        aria-label={`${series.map((each) => each.name).join(", ")} over time`}
        onPointerMove={follow}
        onPointerLeave={() => setCursor(null)}
      >
        {ticks(ys, 5).map((tick) => (
          <g key={tick} className="tick">
            <path d={`M${BOX.x},${y(tick)}h${BOX.width}`} />
            <text x={BOX.x - 5} y={y(tick) + 3.5} textAnchor="end">
              {brief(tick)}
            </text>
          </g>
        ))}
        {ticks(xs, 8).map((tick) => (
          <g key={tick} className="tick">
            <path d={`M${x(tick)},${BOX.y}v${BOX.height}`} />
            <text x={x(tick)} y={HEIGHT - 15} textAnchor="middle">
              {brief(tick)}
            </text>
          </g>
        ))}
        <text className="unit" x={BOX.x + 4} y={BOX.y + 10}>
          {unit}
        </text>
        <text className="unit" x={WIDTH - 8} y={HEIGHT - 3} textAnchor="end">
          t [s]
        </text>
        {series.map((each, i) => (
          <path key={each.name} className={`series s${i % 8}`} d={line(t, each.values, xs, ys, BOX)} />
        ))}
        {time === undefined ? null : <path className="cursor" d={`M${x(time)},${BOX.y}v${BOX.height}`} />}
      </svg>
      <figcaption>
        {series.map((each, i) => (
          <span key={each.name} className="legend">
            <i className={`s${i % 8}`} />
            {each.name}
            {cursor === null ? null : <b>{brief(each.values[cursor] ?? NaN)}</b>}
          </span>
        ))}
        {time === undefined ? null : <span className="legend">t = {brief(time)} s</span>}
      </figcaption>
    </figure>
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
          <Plot key={unit} t={result.t} series={all.filter((each) => each.unit === unit)} unit={unit} />
        ))}
      </div>
    </div>
  );
}
