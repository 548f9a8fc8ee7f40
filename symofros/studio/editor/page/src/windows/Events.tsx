import type { AskedEvent, AskedSimulation } from "../model/asked";
import { IconButton } from "../shell/IconButton";

const DIRECTIONS: readonly AskedEvent["direction"][] = ["both", "rising", "falling"];

interface Props {
  asked: AskedSimulation;
  set(part: Partial<AskedSimulation>): void;
}

/** Instants that a run looks for: zeros of formulas, and limits of joints. */
export function Events({ asked, set }: Props) {
  const { events } = asked;
  const change = (i: number, part: Partial<AskedEvent>): void =>
    set({ events: events.map((event, k) => (k === i ? { ...event, ...part } : event)) });
  const add = (): void => {
    const name = `event ${events.length + 1}`;
    set({ events: [...events, { name, formula: "", direction: "both", terminal: false }] });
  };
  return (
    <fieldset className="kinds events">
      <legend>Events</legend>
      <label>
        <input
          type="checkbox"
          checked={asked.stopAtLimits}
          onChange={({ target }) => set({ stopAtLimits: target.checked })}
        />
        End where a joint reaches a limit
      </label>
      {events.map((event, i) => (
        <div key={i} className="event">
          <input
            aria-label={`Name of event ${i + 1}`}
            value={event.name}
            aria-invalid={event.name.trim() === ""}
            onChange={({ target }) => change(i, { name: target.value })}
          />
          <input
            className="number"
            aria-label={`Formula of event ${i + 1}`}
            placeholder="formula, zero at the event"
            title="Of coordinates, speeds, inputs, parameters and t; its zeros are found"
            value={event.formula}
            aria-invalid={event.formula.trim() === ""}
            spellCheck={false}
            onChange={({ target }) => change(i, { formula: target.value })}
          />
          <select
            aria-label={`Direction of event ${i + 1}`}
            value={event.direction}
            onChange={({ target }) => change(i, { direction: target.value as AskedEvent["direction"] })}
          >
            {DIRECTIONS.map((each) => (
              <option key={each}>{each}</option>
            ))}
          </select>
          <label>
            <input
              type="checkbox"
              checked={event.terminal}
              onChange={({ target }) => change(i, { terminal: target.checked })}
            />
            ends the run
          </label>
          <IconButton
            glyph="close"
            label={`Remove event ${i + 1}`}
            onClick={() => set({ events: events.filter((_, k) => k !== i) })}
          />
        </div>
      ))}
      <button type="button" className="small" onClick={add}>
        Add an event
      </button>
    </fieldset>
  );
}
