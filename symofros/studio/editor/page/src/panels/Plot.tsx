import { memo, useId, useRef } from "react";

import { saveCurves, savePlot } from "../files/plot";
import { type Box, brief, equal, line, nearest, type Span, span, ticks, within } from "../model/plot";
import { pause, setTime } from "../store/playing";
import { useStore } from "../store/store";
import { pointed, usePlotZoom } from "./usePlotZoom";

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
  const zoom = usePlotZoom();
  const clip = useId();
  const picture = useRef<SVGSVGElement>(null);
  const seen =
    zoom.range === null ? curves : curves.map((each) => ({ ...each, ...within(each.x, each.y, zoom.range) }));
  const natural = [zoom.range ?? span(curves.flatMap(({ x }) => x)), span(seen.flatMap(({ y }) => y))] as const;
  const [xs, ys] = plane ? equal(...natural, box) : natural;
  const x = (value: number): number => toX(value, xs, box);
  const y = (value: number): number => box.y + box.height * (1 - (value - ys[0]) / (ys[1] - ys[0]));
  const follow = (event: React.PointerEvent<SVGSVGElement>): void => {
    const at = pointed(event, WIDTH, box, xs);
    if (plane || zoom.move(at) || at === null || !isOfTime) return;
    pause();
    setTime(at);
  };
  const isOfTime = xTitle.startsWith("t ");
  const [from, to] = zoom.drag ?? [0, 0];
  return (
    <figure className={plane ? "plot plane" : "plot"}>
      {title === "" ? null : <h3>{title}</h3>}
      <svg
        ref={picture}
        viewBox={`0 0 ${WIDTH} ${height}`}
        role="img"
        aria-label={label}
        onPointerMove={follow}
        onPointerDown={(event) => zoom.down(plane ? null : pointed(event, WIDTH, box, xs))}
        onPointerUp={() => zoom.up(xs)}
        onDoubleClick={zoom.all}
      >
        <clipPath id={clip}>
          <rect {...box} />
        </clipPath>
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
        <g clipPath={`url(#${clip})`}>
          {seen.map((each, i) => (
            <path key={each.name} className={`series ${colour(curves, i)}`} d={line(each.x, each.y, xs, ys, box)} />
          ))}
        </g>
        {zoom.drag === null ? null : (
          <rect
            className="zoomed"
            x={x(Math.min(from, to))}
            y={box.y}
            width={Math.abs(x(to) - x(from))}
            height={box.height}
          />
        )}
        <Cursor xs={xs} box={box} plane={plane || !isOfTime} />
      </svg>
      <Legend curves={curves} xs={xs} plane={plane || !isOfTime} />
      <p className="plot-tools">
        {zoom.range === null ? null : (
          <button type="button" className="small" onClick={zoom.all}>
            Whole
          </button>
        )}
        <button
          type="button"
          className="small"
          aria-label={`SVG of ${label}`}
          title="The plot as SVG; drag over the plot to look at a part of it"
          onClick={() => picture.current !== null && savePlot(picture.current, title || label, curves)}
        >
          SVG
        </button>
        <button
          type="button"
          className="small"
          aria-label={`CSV of ${label}`}
          title="The plot's curves as CSV"
          onClick={() => saveCurves(title || label, xTitle, curves)}
        >
          CSV
        </button>
      </p>
    </figure>
  );
});
