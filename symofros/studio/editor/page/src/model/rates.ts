/** Sample times as colours: one a period, the fastest first. */

import type { Diagram } from "../api/types";
import { brief } from "./plot";

// Of the series of plots; what is faulty or chosen has other colours.
const COLOURS = 8;

export interface Rate {
  period: number;
  /** Class of its colour. */
  colour: string;
  words: string;
}

/** The periods that occur, each with its colour. */
export function rates(diagram: Diagram): Rate[] {
  const periods = diagram.nodes.flatMap(({ period }) => (period === null ? [] : [period]));
  return [...new Set(periods)]
    .sort((a, b) => a - b)
    .map((period, i) => ({ period, colour: `rate${i % COLOURS}`, words: `${brief(period * 1000)} ms` }));
}

export const colourOf = (all: readonly Rate[], period: number | null): string =>
  all.find((rate) => rate.period === period)?.colour ?? "continuous";
