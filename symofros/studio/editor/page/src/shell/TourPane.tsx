import { useEffect } from "react";

import { EXAMPLE, onward, STEPS } from "../model/tour";
import { takeExample } from "../store/files";
import { update, useStore } from "../store/store";
import { IconButton } from "./IconButton";

/** The step of the tour that is next, over the page; what it asks for is done in the page itself. */
export function TourPane() {
  const tour = useStore((state) => state.tour);
  const document = useStore((state) => state.document);
  const selected = useStore((state) => state.selected);
  const simulated = useStore((state) => state.jobs.simulate);
  const playing = useStore((state) => state.playing);
  useEffect(() => {
    if (tour === null) return;
    const next = onward(tour, { document, selected, simulated, playing });
    if (next !== tour) update({ tour: next });
  }, [tour, document, selected, simulated, playing]);
  const step = tour === null ? undefined : STEPS[tour.step];
  if (tour === null || step === undefined) return null;
  return (
    <aside className="tour" aria-label="Tour">
      <div className="tour-head">
        <h2>
          {tour.step + 1} of {STEPS.length}: {step.title}
        </h2>
        <IconButton glyph="close" label="End the tour" onClick={() => update({ tour: null })} />
      </div>
      <p role="status">{step.text}</p>
      {tour.step === 0 ? (
        <button type="button" className="primary" onClick={() => void takeExample(EXAMPLE)}>
          Open it
        </button>
      ) : null}
    </aside>
  );
}
