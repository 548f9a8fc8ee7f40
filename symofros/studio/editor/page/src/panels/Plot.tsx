import { useState } from "react";

import { brief, equal, line, span, ticks } from "../model/plot";

export interface PlotCurve {
  name: string;
  x: readonly (number | null)[];
  /** Null where a run diverged. */
  y: readonly (number | null)[];
}

interface Props {
  curves: readonly PlotCurve[];
  label: string;
  /** What the axes measure. */
  xTitle: string;
  unit: string;
  title?: string;
  /** Points of a plane, at one scale; else all curves are over the same times. */
  plane?: boolean;
}

const WIDTH = 640;

/** Curves with scales, and the values under the pointer where they are over time. */
export function Plot({ curves, label, xTitle, unit, title = "", plane = false }: Props) {
  const [cursor, setCursor] = useState<number | null>(null);
  const height = plane ? 380 : 200;
  const box = { x: 56, y: 8, width: WIDTH - 64, height: height - 34 };
  const t = curves[0]?.x ?? [];
  const natural = [span(plane ? curves.flatMap(({ x }) => x) : t), span(curves.flatMap(({ y }) => y))] as const;
  const [xs, ys] = plane ? equal(...natural, box) : natural;
  const x = (value: number): number => box.x + (box.width * (value - xs[0])) / (xs[1] - xs[0]);
  const y = (value: number): number => box.y + box.height * (1 - (value - ys[0]) / (ys[1] - ys[0]));
  const time = cursor === null ? null : (t[cursor] ?? null);
  const follow = (event: React.PointerEvent<SVGSVGElement>): void => {
    const frame = event.currentTarget.getBoundingClientRect();
    const share = (((event.clientX - frame.left) / frame.width) * WIDTH - box.x) / box.width;
    setCursor(plane || share < 0 || share > 1 ? null : Math.round(share * (t.length - 1)));
  };
  return (
    <figure className={plane ? "plot plane" : "plot"}>
      {title === "" ? null : <h3>{title}</h3>}
      <svg
        viewBox={`0 0 ${WIDTH} ${height}`}
        role="img"
        aria-label={label}
        onPointerMove={follow}
        onPointerLeave={() => setCursor(null)}
      >
        {ticks(ys, 5).map((tick) => (
          <g key={tick} className="tick">
            <path d={`M${box.x},${y(tick)}h${box.width}`} />
            <text x={box.x - 5} y={y(tick) + 3.5} textAnchor="end">
              {brief(tick)}
            </text>
          </g>
        ))}
        {ticks(xs, 8).map((tick) => (
          <g key={tick} className="tick">
            <path d={`M${x(tick)},${box.y}v${box.height}`} />
            <text x={x(tick)} y={height - 15} textAnchor="middle">
              {brief(tick)}
            </text>
          </g>
        ))}
        <text className="unit" x={box.x + 4} y={box.y + 10}>
          {unit}
        </text>
        <text className="unit" x={WIDTH - 8} y={height - 3} textAnchor="end">
          {xTitle}
        </text>
        {curves.map((each, i) => (
          <path key={each.name} className={`series s${i % 8}`} d={line(each.x, each.y, xs, ys, box)} />
        ))}
        {time === null ? null : <path className="cursor" d={`M${x(time)},${box.y}v${box.height}`} />}
      </svg>
      <figcaption>
        {curves.map((each, i) => (
          <span key={each.name} className="legend">
            <i className={`s${i % 8}`} />
            {each.name}
            {cursor === null ? null : <b>{brief(each.y[cursor] ?? NaN)}</b>}
          </span>
        ))}
        {time === null ? null : <span className="legend">t = {brief(time)} s</span>}
      </figcaption>
    </figure>
  );
}
