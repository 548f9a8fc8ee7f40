/** A part of a plot's x axis that is looked at: chosen by a drag over it, left by a double click. */

import { useState } from "react";

import type { Box, Span } from "../model/plot";

// A drag over less of the plot's width is a click.
const LEAST = 0.015;

interface Zoom {
  /** What is looked at; null where it is all. */
  range: Span | null;
  /** What is being chosen. */
  drag: Span | null;
  all(): void;
  down(x: number | null): void;
  /** Whether a part is being chosen: then the cursor stays where it is. */
  move(x: number | null): boolean;
  up(xs: Span): void;
}

export function usePlotZoom(): Zoom {
  const [range, setRange] = useState<Span | null>(null);
  const [drag, setDrag] = useState<Span | null>(null);
  return {
    range,
    drag,
    all: () => setRange(null),
    down: (x) => setDrag(x === null ? null : [x, x]),
    move: (x) => {
      if (drag === null) return false;
      if (x !== null) setDrag([drag[0], x]);
      return true;
    },
    up: ([low, high]) => {
      if (drag !== null && Math.abs(drag[1] - drag[0]) > LEAST * (high - low))
        setRange([Math.min(...drag), Math.max(...drag)]);
      setDrag(null);
    },
  };
}

/** Where on the x axis a pointer is; null outside of the box. */
export function pointed(event: React.PointerEvent<SVGSVGElement>, width: number, box: Box, xs: Span): number | null {
  const frame = event.currentTarget.getBoundingClientRect();
  const share = (((event.clientX - frame.left) / frame.width) * width - box.x) / box.width;
  return share < 0 || share > 1 ? null : xs[0] + share * (xs[1] - xs[0]);
}
