import { memo } from "react";

import { type Box, brief, equal, line, nearest, type Span, span, ticks } from "../model/plot";
import { pause, setTime } from "../store/playing";
import { useStore } from "../store/store";

export interface PlotCurve {
  name: string;
  x: readonly (number | null)[];
  /** Null where a run diverged. */
  y: readonly (number | null)[];
  /** Of an earlier run: the curve of the newest that it is drawn beside. */
  beside?: string;
}

interface Props {
  curves: readonly PlotCurve[];
  label: string;
  /** What the axes measure. */
  xTitle: string;
  unit: string;
  title?: string;
  /** Points of a plane, at one scale; else all curves are over times. */
  plane?: boolean;
}

const WIDTH = 640;

/** A curve's colour: that of the one beside which it is drawn, else its own. */
function colour(curves: readonly PlotCurve[], i: number): string {
  const beside = curves.findIndex(({ name }) => name === curves[i]?.beside);
  return `s${(beside >= 0 ? beside : i) % 8}${beside >= 0 ? " earlier" : ""}`;
}

const toX = (value: number, [low, high]: Span, box: Box): number => box.x + (box.width * (value - low)) / (high - low);

/** Where the plots' cursor is, where the plot has that time. */
function useCursor(plane: boolean, [low, high]: Span): number | null {
  const time = useStore((state) => state.time);
  return plane || time === null || time < low || time > high ? null : time;
}

function Cursor({ xs, box, plane }: { xs: Span; box: Box; plane: boolean }) {
  const time = useCursor(plane, xs);
  return time === null ? null : <path className="cursor" d={`M${toX(time, xs, box)},${box.y}v${box.height}`} />;
}

function Legend({ curves, xs, plane }: { curves: readonly PlotCurve[]; xs: Span; plane: boolean }) {
  const time = useCursor(plane, xs);
  return (
    <figcaption>
      {curves.map((each, i) => (
        <span key={each.name} className="legend">
          <i className={colour(curves, i)} />
          {each.name}
          {time === null ? null : <b>{brief(each.y[nearest(each.x, time)] ?? NaN)}</b>}
        </span>
      ))}
      {time === null ? null : <span className="legend">t = {brief(time)} s</span>}
    </figcaption>
  );
}

/** Curves with scales, and the values at the time where the cursor is; moving over one moves the cursor of all. */
export const Plot = memo(function Plot({ curves, label, xTitle, unit, title = "", plane = false }: Props) {
  const height = plane ? 380 : 200;
  const box = { x: 56, y: 8, width: WIDTH - 64, height: height - 34 };
  const natural = [span(curves.flatMap(({ x }) => x)), span(curves.flatMap(({ y }) => y))] as const;
  const [xs, ys] = plane ? equal(...natural, box) : natural;
  const x = (value: number): number => toX(value, xs, box);
  const y = (value: number): number => box.y + box.height * (1 - (value - ys[0]) / (ys[1] - ys[0]));
  const follow = (event: React.PointerEvent<SVGSVGElement>): void => {
    const frame = event.currentTarget.getBoundingClientRect();
    const share = (((event.clientX - frame.left) / frame.width) * WIDTH - box.x) / box.width;
    if (plane || share < 0 || share > 1) return;
    pause();
    setTime(xs[0] + share * (xs[1] - xs[0]));
  };
  return (
    <figure className={plane ? "plot plane" : "plot"}>
      {title === "" ? null : <h3>{title}</h3>}
      <svg viewBox={`0 0 ${WIDTH} ${height}`} role="img" aria-label={label} onPointerMove={follow}>
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
          <path key={each.name} className={`series ${colour(curves, i)}`} d={line(each.x, each.y, xs, ys, box)} />
        ))}
        <Cursor xs={xs} box={box} plane={plane} />
      </svg>
      <Legend curves={curves} xs={xs} plane={plane} />
    </figure>
  );
});
