import { useState } from "react";

import { isNumber } from "../forms/values";
import type { AskedRun } from "../model/asked";
import { at } from "../model/paths";
import { Foot } from "../shell/Foot";
import { Row } from "../shell/Row";
import { Window } from "../shell/Window";
import { askedRun, keepRun } from "../store/asked";
import { run } from "../store/jobs";
import { DocsPage } from "./Help";
import { dismiss, useDocument, useStore } from "../store/store";

const isPositive = (text: string): boolean => text.trim() === "" || (isNumber(text) && Number(text) > 0);
const times = (text: string): string[] => text.split(/[\s,;]+/).filter(Boolean);

interface TextProps {
  title: string;
  unit: string;
  text: string;
  hint: string;
  isRight: boolean;
  onChange(text: string): void;
}

function NumberRow({ title, unit, text, hint, isRight, onChange }: TextProps) {
  return (
    <Row title={title} unit={unit}>
      {(id) => (
        <input
          id={id}
          className="number"
          value={text}
          placeholder={hint}
          aria-invalid={!isRight}
          spellCheck={false}
          onChange={(event) => onChange(event.target.value)}
        />
      )}
    </Row>
  );
}

/** How to run the diagram, where it shall not be as its file says. */
export function RunForm() {
  const { data } = useDocument();
  const methods = useStore((state) => state.catalogue?.methods) ?? [];
  const [asked, setAsked] = useState(askedRun);
  const set = (part: Partial<AskedRun>): void => setAsked({ ...asked, ...part });
  const stated = (key: string, otherwise: string): string => String(at(data, ["simulation", key]) ?? otherwise);
  const areStopsRight = times(asked.stops).every((text) => isNumber(text) && Number(text) >= 0);
  const isFine = [asked.end, asked.step, asked.pace].every(isPositive) && areStopsRight;
  const start = (): void => {
    if (!isFine) return;
    keepRun(asked);
    dismiss();
    const { mode, end, step, method, pace, stops } = asked;
    const given = { t_end: end, dt: step, realtime: mode === "compiled" ? pace : "" };
    const numbers = Object.entries(given).filter(([, text]) => text.trim() !== "");
    void run("run", {
      mode,
      ...(method === "" ? {} : { method }),
      ...Object.fromEntries(numbers.map(([key, text]) => [key, Number(text)])),
      breakpoints: times(stops).map(Number),
    });
  };
  return (
    <Window title="Run" onClose={dismiss} onSubmit={start} foot={<Foot word="Run" disabled={!isFine} />}>
      <Row title="How">
        {(id) => (
          <select
            id={id}
            value={asked.mode}
            onChange={(event) => set({ mode: event.target.value as AskedRun["mode"] })}
          >
            <option value="compiled">compiled: the whole diagram as one C program</option>
            <option value="interpreted">interpreted: block by block, some hundred times slower</option>
          </select>
        )}
      </Row>
      <NumberRow
        title="End"
        unit="s"
        text={asked.end}
        hint={stated("t_end", "1")}
        isRight={isPositive(asked.end)}
        onChange={(end) => set({ end })}
      />
      <NumberRow
        title="Step"
        unit="s"
        text={asked.step}
        hint={stated("dt", "by the method")}
        isRight={isPositive(asked.step)}
        onChange={(step) => set({ step })}
      />
      <Row title="Method">
        {(id) => (
          <select id={id} value={asked.method} onChange={(event) => set({ method: event.target.value })}>
            <option value="">{stated("method", "rk4")}</option>
            {methods.map(({ name, help }) => (
              <option key={name} value={name} title={help}>
                {name.replaceAll("_", " ")}
              </option>
            ))}
          </select>
        )}
      </Row>
      {asked.mode === "compiled" ? (
        <NumberRow
          title="Pace"
          unit="× clock"
          text={asked.pace}
          hint={stated("realtime", "as fast as can be")}
          isRight={isPositive(asked.pace)}
          onChange={(pace) => set({ pace })}
        />
      ) : null}
      <NumberRow
        title="Pause at"
        unit="s"
        text={asked.stops}
        hint="times, such as 3, 5"
        isRight={areStopsRight}
        onChange={(stops) => set({ stops })}
      />
      <DocsPage page="docs/diagrams.md" />
    </Window>
  );
}
