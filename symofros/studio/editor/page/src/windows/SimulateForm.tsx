import { isNumber } from "../forms/values";
import { type AskedSimulation, known, strangers } from "../model/asked";
import { inputs, rates, starts } from "../model/motion";
import { Foot } from "../shell/Foot";
import { Row } from "../shell/Row";
import { Window } from "../shell/Window";
import { isAdaptive, keepSimulation, simulationOptions } from "../store/asked";
import { run } from "../store/jobs";
import { DocsPage } from "./Help";
import { dismiss, show, useDocument, useStore } from "../store/store";
import { Events } from "./Events";
import { LeftOut, NameTable } from "./NameTable";

const positive = (text: string): boolean => isNumber(text) && Number(text) > 0;

function NumberRow({
  title,
  unit,
  text,
  onChange,
}: {
  title: string;
  unit: string;
  text: string;
  onChange(text: string): void;
}) {
  return (
    <Row title={title} unit={unit}>
      {(id) => (
        <input
          id={id}
          className="number"
          value={text}
          aria-invalid={!positive(text)}
          onChange={(event) => onChange(event.target.value)}
        />
      )}
    </Row>
  );
}

const unitOf = (unit: string): string => (unit === "" ? "" : ` [${unit}]`);

/** Starts of coordinates and speeds, and laws of inputs; of what is there no more, that it is left out. */
function Given({ asked, set }: { asked: AskedSimulation; set(part: Partial<AskedSimulation>): void }) {
  const { data } = useDocument();
  const [positions, speeds, driven] = [starts(data), rates(data), inputs(data)];
  const names = { q0: positions, v0: speeds, inputs: driven } as const;
  const of = (key: keyof typeof names): string[] => names[key].map(({ name }) => name);
  const keys = Object.keys(names) as (keyof typeof names)[];
  const rows = [...positions, ...speeds.filter(({ name }) => !of("q0").includes(name))].map(({ name, unit }) => {
    const speed = speeds.find((each) => each.name === name)?.unit ?? "";
    return { name, unit, title: `${name}${unitOf(unit)}${speed === "" ? "" : `, speed${unitOf(speed)}`}` };
  });
  const isGiven = keys.some((key) => Object.values(asked[key]).some((text) => text.trim() !== ""));
  return (
    <>
      <NameTable
        head="Coordinate"
        rows={rows}
        columns={[
          { title: "Start", names: of("q0"), texts: asked.q0, isRight: isNumber, onChange: (q0) => set({ q0 }) },
          { title: "Speed", names: of("v0"), texts: asked.v0, isRight: isNumber, onChange: (v0) => set({ v0 }) },
        ]}
      />
      <NameTable
        head="Input"
        rows={driven.map(({ name, fallback }) => ({ name, unit: "", title: name, fallback }))}
        columns={[
          {
            title: "Formula",
            names: of("inputs"),
            texts: asked.inputs,
            isRight: () => true,
            onChange: (texts) => set({ inputs: texts }),
          },
        ]}
      />
      <LeftOut
        texts={keys.flatMap((key) => Object.entries(strangers(asked[key], of(key))))}
        forget={() => set(Object.fromEntries(keys.map((key) => [key, known(asked[key], of(key))])))}
      />
      {isGiven ? (
        <button type="button" className="small" onClick={() => set({ q0: {}, v0: {}, inputs: {} })}>
          Clear starts and inputs
        </button>
      ) : null}
    </>
  );
}

/** What to simulate: from where, driven by what, how long, by which method. */
export function SimulateForm({ asked }: { asked: AskedSimulation }) {
  const { data } = useDocument();
  const methods = useStore((state) => state.catalogue?.methods) ?? [];
  const set = (part: Partial<AskedSimulation>): void => show({ kind: "simulate", asked: { ...asked, ...part } });
  const adaptive = isAdaptive(asked.method);
  const q0 = known(
    asked.q0,
    starts(data).map(({ name }) => name),
  );
  const v0 = known(
    asked.v0,
    rates(data).map(({ name }) => name),
  );
  const isFine =
    positive(asked.end) &&
    positive(adaptive ? asked.tolerance : asked.step) &&
    asked.events.every(({ name, formula }) => name.trim() !== "" && formula.trim() !== "") &&
    [...Object.values(q0), ...Object.values(v0)].every(isNumber);
  const begin = (kind: "simulate" | "page"): void => {
    if (!isFine) return;
    keepSimulation(asked);
    dismiss();
    const { from, course } = simulationOptions(asked);
    // The page goes on and on, and has sliders.
    void run(kind, kind === "simulate" ? { ...from, ...course } : from);
  };
  return (
    <Window
      title="Simulate"
      onClose={dismiss}
      onSubmit={() => begin("simulate")}
      foot={
        <>
          <button
            type="button"
            disabled={!isFine}
            title="Compile to WebAssembly: then this page simulates by itself, without end, with sliders of inputs and parameters"
            onClick={() => begin("page")}
          >
            In this page
          </button>
          <Foot word="Simulate" disabled={!isFine} />
        </>
      }
    >
      <NumberRow title="Duration" unit="s" text={asked.end} onChange={(end) => set({ end })} />
      <Row title="Method">
        {(id) => (
          <select id={id} value={asked.method} onChange={(event) => set({ method: event.target.value })}>
            {methods.map(({ name, help }) => (
              <option key={name} value={name} title={help}>
                {name.replaceAll("_", " ")}
              </option>
            ))}
          </select>
        )}
      </Row>
      {adaptive ? (
        <NumberRow
          title="Tolerance"
          unit="relative"
          text={asked.tolerance}
          onChange={(tolerance) => set({ tolerance })}
        />
      ) : (
        <NumberRow title="Step" unit="s" text={asked.step} onChange={(step) => set({ step })} />
      )}
      <Given asked={asked} set={set} />
      <Events asked={asked} set={set} />
      <DocsPage page="docs/howto/simulating.md" />
    </Window>
  );
}
