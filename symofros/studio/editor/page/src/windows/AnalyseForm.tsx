import { isNumber } from "../forms/values";
import { type AskedAnalysis, type AskedSimulation, known } from "../model/asked";
import { inputs, rates, starts } from "../model/motion";
import { Foot } from "../shell/Foot";
import { Row } from "../shell/Row";
import { Window } from "../shell/Window";
import { keepAnalysis, keepSimulation, simulationOptions } from "../store/asked";
import { run } from "../store/jobs";
import { dismiss, show, update, useDocument } from "../store/store";
import { DocsPage } from "./Help";
import { NameTable } from "./NameTable";
import { isComplete, OutputFields, SweepFields } from "./SweepFields";

const KINDS: Record<string, { title: string; help: string }> = {
  equilibrium: { title: "Equilibrium", help: "where the mechanism rests, and what holds it there" },
  modes: { title: "Vibration modes", help: "frequencies, damping and shapes, which play in 3-D" },
  linear: { title: "Linear model", help: "A, B and eigenvalues" },
  sweep: { title: "Sweep", help: "frequencies or motions at several values of a parameter" },
  advise: { title: "Advice", help: "what may be left out where some outputs matter, each reduction simulated" },
};

const names = (rows: readonly { name: string }[]): string[] => rows.map(({ name }) => name);
const numbers = (texts: Record<string, string>): Record<string, number> =>
  Object.fromEntries(Object.entries(texts).map(([name, text]) => [name, Number(text)]));

/** Coordinates that stay where the state has them. */
function Held({ asked, set }: { asked: AskedAnalysis; set(part: Partial<AskedAnalysis>): void }) {
  const { data } = useDocument();
  const toggle = (name: string, isHeld: boolean): void =>
    set({ held: isHeld ? [...asked.held, name] : asked.held.filter((each) => each !== name) });
  return (
    <fieldset className="kinds held">
      <legend>Held where they are</legend>
      {names(rates(data)).map((name) => (
        <label key={name}>
          <input
            type="checkbox"
            checked={asked.held.includes(name)}
            onChange={({ target }) => toggle(name, target.checked)}
          />
          {name}
        </label>
      ))}
    </fieldset>
  );
}

/** What to compute about the model, and about which state. */
export function AnalyseForm({ asked, state }: { asked: AskedAnalysis; state: AskedSimulation }) {
  const { data } = useDocument();
  const set = (part: Partial<AskedAnalysis>): void => show({ kind: "analyse", asked: { ...asked, ...part }, state });
  const q0 = known(state.q0, names(starts(data)));
  const u = known(asked.u, names(inputs(data)));
  const isFine = [...Object.values(q0), ...Object.values(u)].every(isNumber) && isComplete(asked);
  const begin = (): void => {
    if (!isFine) return;
    keepAnalysis(asked);
    keepSimulation(state);
    update({ shape: "" });
    dismiss();
    const held = asked.held.filter((name) => names(rates(data)).includes(name));
    const { from, course } = simulationOptions(state);
    const { what, about, of, parameter, count } = asked;
    const outputs = asked.outputs.map((each) => ({ ...each, absolute: Number(each.absolute) }));
    const range = { parameter, of, low: Number(asked.low), high: Number(asked.high), count: Number(count) };
    const more = what === "sweep" ? { ...course, ...range } : what === "advise" ? { ...course, outputs } : {};
    // Of a rest the window states no speeds: those of the window Simulate are not meant.
    void run("analyse", { ...(isMotion ? from : { q0: from.q0 }), ...more, what, about, held, u: numbers(u) });
  };
  const { what } = asked;
  const isMotion = what === "advise" || (what === "sweep" && asked.of === "motion");
  const isAboutState = what === "modes" || what === "linear" || (what === "sweep" && !isMotion);
  const isSearched = what === "equilibrium" || (isAboutState && asked.about === "equilibrium");
  return (
    <Window title="Analyse" onClose={dismiss} onSubmit={begin} foot={<Foot word="Analyse" disabled={!isFine} />}>
      <fieldset className="kinds">
        <legend>What</legend>
        {Object.entries(KINDS).map(([kind, { title, help }]) => (
          <label key={kind}>
            <input type="radio" name="what" checked={asked.what === kind} onChange={() => set({ what: kind })} />
            <span>
              {title}
              <span className="quiet">: {help}</span>
            </span>
          </label>
        ))}
      </fieldset>
      {what === "sweep" ? <SweepFields asked={asked} set={set} /> : null}
      {what === "advise" ? <OutputFields asked={asked} set={set} /> : null}
      {!isAboutState ? null : (
        <Row title="About">
          {(id) => (
            <select
              id={id}
              value={asked.about}
              onChange={({ target }) => set({ about: target.value as AskedAnalysis["about"] })}
            >
              <option value="equilibrium">the equilibrium that is found from here</option>
              <option value="pose">the state itself</option>
            </select>
          )}
        </Row>
      )}
      <NameTable
        head="Coordinate"
        rows={starts(data).map(({ name, unit }) => ({ name, unit, title: name }))}
        columns={[
          {
            title: isSearched ? "Guess" : "Start",
            names: names(starts(data)),
            texts: state.q0,
            isRight: isNumber,
            onChange: (q0) => show({ kind: "analyse", asked, state: { ...state, q0 } }),
          },
        ]}
      />
      <NameTable
        head="Input"
        rows={(isMotion ? [] : inputs(data)).map(({ name, fallback }) => ({ name, unit: "", title: name, fallback }))}
        columns={[
          {
            title: "Value",
            names: names(inputs(data)),
            texts: asked.u,
            isRight: isNumber,
            onChange: (texts) => set({ u: texts }),
          },
        ]}
      />
      {isSearched ? <Held asked={asked} set={set} /> : null}
      <DocsPage page={what === "advise" ? "docs/advise.md" : "docs/theory/linear.md"} />
    </Window>
  );
}
