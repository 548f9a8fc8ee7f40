/** The tour: five steps from an example to its motion, each over when the page sees that it was done. */

import type { Job } from "../api/jobs";
import type { Document } from "../api/types";

/** Where somebody is in the tour: the step, and the step of undo that the document was at when it began. */
export interface Tour {
  step: number;
  since: number;
}

/** What the steps look at. */
export interface Seen {
  document: Document | null;
  selected: readonly string[];
  simulated: Job | undefined;
  playing: boolean;
}

interface Step {
  title: string;
  text: string;
  isDone(seen: Seen, tour: Tour): boolean;
}

export const EXAMPLE = "double_pendulum";

export const STEPS: readonly Step[] = [
  {
    title: "Open an example",
    text: "Choose Double pendulum in File > Examples, or press the button here.",
    isDone: ({ document }) => document?.name.startsWith(EXAMPLE) === true,
  },
  {
    title: "Choose a body",
    text: "Click the block lower. Its square is its joint, its circles are its frames.",
    isDone: ({ selected }) => selected.some((id) => id.startsWith("bodies/")),
  },
  {
    title: "Change a parameter",
    text: "In the table at the right, type another value for L2, the length of the lower rod, and press Enter.",
    isDone: ({ document }, { since }) => document !== null && document.step !== since,
  },
  {
    title: "Simulate",
    text: "Press Simulate… in the tool bar, then Simulate. The equations are derived and compiled, then integrated.",
    isDone: ({ simulated }) => simulated?.state === "done",
  },
  {
    title: "Play it",
    text: "Press Play under the diagram: the mechanism moves in three dimensions.",
    isDone: ({ playing }) => playing,
  },
];

/** The tour after what was seen: the next step, or none after the last. */
export function onward(tour: Tour, seen: Seen): Tour | null {
  const step = STEPS[tour.step];
  if (step === undefined || !step.isDone(seen, tour)) return tour;
  return tour.step + 1 < STEPS.length ? { step: tour.step + 1, since: seen.document?.step ?? 0 } : null;
}
