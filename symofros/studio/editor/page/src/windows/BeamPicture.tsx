import { brief } from "../model/plot";
import { cantilever } from "../model/bending";

const WIDTH = 300;
const LEFT = 22;
const SPAN = 200;
const MIDDLE = 46;
const SWING = 22;
const STATIONS = Array.from({ length: 41 }, (_, i) => i / 40);

interface Props {
  /** As the file states it. */
  length: string;
  /** The first natural frequencies of bending in one plane [Hz]. */
  frequencies: readonly number[];
  motion: string;
}

/** A beam, clamped at its root, and the shapes of its first vibrations in one plane. */
export function BeamPicture({ length, frequencies, motion }: Props) {
  const curve = (mode: number): string =>
    STATIONS.map((xi) => `${LEFT + SPAN * xi},${(MIDDLE - (SWING * cantilever(mode, xi)) / 2).toFixed(1)}`).join(" ");
  return (
    <figure className="beam-picture">
      <svg width={WIDTH} height={92} role="img" aria-label={`The beam and its first vibrations: ${motion}`}>
        <path
          className="clamp"
          d={`M${LEFT},${MIDDLE - 24}v48M${LEFT},${MIDDLE - 20}l-9,8m9,2l-9,8m9,2l-9,8m9,2l-9,8`}
        />
        <path className="beam" d={`M${LEFT},${MIDDLE}h${SPAN}`} />
        {frequencies.map((hertz, mode) => (
          <g key={mode}>
            <polyline className={`series s${mode}`} points={curve(mode)} />
            <text x={LEFT + SPAN + 10} y={MIDDLE - 14 + 18 * mode} style={{ fill: `var(--s${mode})` }}>
              {brief(hertz)} Hz
            </text>
          </g>
        ))}
      </svg>
      <figcaption>
        {length === "" ? "" : `${length} long; `}
        {motion}, clamped at its root
      </figcaption>
    </figure>
  );
}
