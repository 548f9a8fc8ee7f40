import { line, span } from "../model/plot";

interface Props {
  x: readonly number[];
  series: readonly (readonly number[])[];
  width: number;
  height: number;
  label: string;
}

/** Curves without numbers: a thumbnail. */
export function Curve({ x, series, width, height, label }: Props) {
  const box = { x: 3, y: 3, width: width - 6, height: height - 6 };
  const xs = span(x);
  const ys = span(series.flat());
  const zero = box.y + box.height * (ys[1] / (ys[1] - ys[0]));
  return (
    <svg className="curve" width={width} height={height} role="img" aria-label={label}>
      <path className="axis" d={`M${box.x},${zero}h${box.width}`} />
      {series.map((values, i) => (
        <path key={i} className={`series s${i % 8}`} d={line(x, values, xs, ys, box)} />
      ))}
    </svg>
  );
}
