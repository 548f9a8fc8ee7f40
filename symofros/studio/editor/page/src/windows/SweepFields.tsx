import { isNumber } from "../forms/values";
import type { AskedAnalysis, AskedOutput } from "../model/asked";
import { rates, starts } from "../model/motion";
import { allFrames } from "../model/names";
import { IconButton } from "../shell/IconButton";
import { Row } from "../shell/Row";
import { useDocument } from "../store/store";

interface Props {
  asked: AskedAnalysis;
  set(part: Partial<AskedAnalysis>): void;
}

const positive = (text: string): boolean => isNumber(text) && Number(text) > 0;
const names = (rows: readonly { name: string }[]): string[] => rows.map(({ name }) => name);

const digits = (value: number): string => String(Number(value.toPrecision(6)));

const FIELDS = [
  { key: "low", title: "From" },
  { key: "high", title: "To" },
  { key: "count", title: "Values" },
] as const;

/** Whether what is typed of a sweep or of advice is complete. */
export function isComplete({ what, parameter, low, high, count, outputs }: AskedAnalysis): boolean {
  if (what === "sweep") return parameter !== "" && [low, high].every(isNumber) && Number(count) >= 2;
  return (
    what !== "advise" || (outputs.length > 0 && outputs.every(({ of, absolute }) => of !== "" && positive(absolute)))
  );
}

/** Over which parameter, and what is drawn. */
export function SweepFields({ asked, set }: Props) {
  const { parameters } = useDocument();
  const swept = parameters.filter(({ number, constant }) => number !== null && !constant);
  const choose = (name: string): void => {
    const value = swept.find((each) => each.name === name)?.number ?? 1;
    set({ parameter: name, low: digits(0.5 * value), high: digits(1.5 * value) });
  };
  if (swept.length === 0)
    return (
      <p className="quiet">
        The model has no parameter that a sweep could change. Write a name in place of a number in a body's window, and
        add it as a parameter there.
      </p>
    );
  return (
    <>
      <Row title="Parameter">
        {(id) => (
          <select id={id} value={asked.parameter} onChange={({ target }) => choose(target.value)}>
            <option value="">choose one</option>
            {swept.map(({ name }) => (
              <option key={name}>{name}</option>
            ))}
          </select>
        )}
      </Row>
      {FIELDS.map(({ key, title }) => (
        <Row key={key} title={title}>
          {(id) => (
            <input
              id={id}
              className="number"
              value={asked[key]}
              aria-invalid={asked.parameter !== "" && !isNumber(asked[key])}
              onChange={({ target }) => set({ [key]: target.value })}
            />
          )}
        </Row>
      ))}
      <Row title="Drawn">
        {(id) => (
          <select id={id} value={asked.of} onChange={({ target }) => set({ of: target.value as AskedAnalysis["of"] })}>
            <option value="frequencies">frequencies of the modes</option>
            <option value="motion">motions, as the window Simulate says</option>
          </select>
        )}
      </Row>
    </>
  );
}

const KINDS: Record<AskedOutput["kind"], string> = {
  position: "position of frame",
  coordinate: "coordinate",
  speed: "speed",
};

/** What of the motion matters, and how exact it has to be. */
export function OutputFields({ asked, set }: Props) {
  const { data } = useDocument();
  const { outputs } = asked;
  const known = { position: allFrames(data), coordinate: names(starts(data)), speed: names(rates(data)) };
  const change = (i: number, part: Partial<AskedOutput>): void =>
    set({ outputs: outputs.map((output, k) => (k === i ? { ...output, ...part } : output)) });
  return (
    <fieldset className="kinds events">
      <legend>What matters in the motion that the window Simulate says</legend>
      {outputs.map((output, i) => (
        <div key={i} className="event">
          <select
            aria-label={`Kind of output ${i + 1}`}
            value={output.kind}
            onChange={({ target }) => change(i, { kind: target.value as AskedOutput["kind"], of: "" })}
          >
            {Object.entries(KINDS).map(([kind, title]) => (
              <option key={kind} value={kind}>
                {title}
              </option>
            ))}
          </select>
          <select
            aria-label={`Name of output ${i + 1}`}
            value={output.of}
            aria-invalid={output.of === ""}
            onChange={({ target }) => change(i, { of: target.value })}
          >
            <option value="">choose one</option>
            {known[output.kind].map((name) => (
              <option key={name}>{name}</option>
            ))}
          </select>
          <input
            className="number"
            aria-label={`Tolerance of output ${i + 1}`}
            title="Error that does no harm, in its own unit"
            value={output.absolute}
            aria-invalid={!positive(output.absolute)}
            onChange={({ target }) => change(i, { absolute: target.value })}
          />
          <IconButton
            glyph="close"
            label={`Remove output ${i + 1}`}
            onClick={() => set({ outputs: outputs.filter((_, k) => k !== i) })}
          />
        </div>
      ))}
      <button
        type="button"
        className="small"
        onClick={() => set({ outputs: [...outputs, { kind: "position", of: "", absolute: "0.001" }] })}
      >
        Add an output
      </button>
    </fieldset>
  );
}
