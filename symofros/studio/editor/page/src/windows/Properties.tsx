import { useCallback, useMemo, useRef, useState } from "react";

import type { Json, Path } from "../api/types";
import { fileOf } from "../canvas/open";
import { Form, type FormContext } from "../forms/context";
import { asTyped, changes, keyOf, type Renames } from "../model/changes";
import { at, difference, isMap, mapAt, textAt } from "../model/paths";
import { Foot } from "../shell/Foot";
import { TextRow } from "../shell/Row";
import { Window } from "../shell/Window";
import { edit } from "../store/edits";
import { enter } from "../store/files";
import { closing, dismiss, useDocument, useStore } from "../store/store";
import { beside, SYSTEM } from "../model/sections";
import { BodyForm } from "./BodyForm";
import { DiagramForm } from "./DiagramForm";
import { EntryForm } from "./EntryForm";
import { Help } from "./Help";
import { GravityForm, SwitchForm, SystemForm } from "./SystemForm";

const NOUNS: Record<string, string> = {
  bodies: "Body",
  closures: "Closure",
  connections: "Connection",
  contacts: "Contact",
  nonholonomic: "Condition",
  blocks: "Block",
  models: "Model",
  parts: "Part",
  simulation: "Simulation",
  wires: "Wires",
};

async function goIn(file: string): Promise<void> {
  const close = closing();
  if (await enter(file)) close();
}

/** The window of a block, a link or the whole system. Nothing is changed until it is accepted, as one step of undo. */
export function Properties({ path, entry }: { path: Path; entry: Path }) {
  const document = useDocument();
  const catalogue = useStore((state) => state.catalogue);
  const diagram = document.diagram;
  const schema = diagram === null ? catalogue?.schema : catalogue?.diagram.schema;
  const section = String(path[0]);
  const isSystem = section === "system";
  // What the window was opened with; changes from elsewhere do not touch what is being typed.
  const [data] = useState(document.data);
  const [before] = useState(() => (isSystem ? data : at(data, path)));
  const [draft, setDraft] = useState<Json | undefined>(before);
  // The base is the ground, and gravity is what the ground has, whether it is a body or not.
  const isGround = section === "bodies" && isMap(draft) && draft["joint"] === undefined;
  const other = useMemo(() => (diagram === null ? beside(path) : null), [diagram, path]);
  const [aside, setAside] = useState<Json | undefined>(() => (other === null ? undefined : at(data, other)));
  const [renames, setRenames] = useState<Renames>({});
  const name = renames[keyOf(path)] ?? String(path.at(-1));
  const [hint, setHint] = useState("");
  const typed = useRef(new Map<string, string>());
  const type = useCallback((place: Path, text: string) => void typed.current.set(keyOf(place), text.trim()), []);
  const rename = useCallback(
    (place: Path, to: string) => setRenames((all) => ({ ...all, [keyOf(place)]: to.trim() })),
    [],
  );
  const newest = useRef(draft);
  newest.current = draft;
  const newestAside = useRef(aside);
  newestAside.current = aside;
  const context = useMemo<FormContext>(
    () => ({
      root: schema ?? {},
      data,
      body: section === "bodies" ? String(path[1]) : null,
      renames,
      rename,
      type,
      hint: setHint,
      draft: (place) => {
        const isAside = place[0] === other?.[0];
        const whole = isSystem ? place.slice(0, 1) : isAside && other !== null ? other : path;
        const value = isAside ? newestAside.current : isSystem ? at(newest.current, whole) : newest.current;
        return value === undefined ? null : { path: whole, value };
      },
      choices: (key, record) => {
        if (diagram === null) return null;
        if (key === "model") return Object.keys(diagram.models);
        if (["leave", "enter", "first"].includes(key) && at(newest.current, ["kind"]) === "state_machine")
          return Object.keys(mapAt(newest.current, ["machine_states"]));
        return key === "frame" ? (diagram.models[textAt(record, ["model"]) ?? ""]?.frames ?? null) : null;
      },
    }),
    [schema, data, diagram, section, path, isSystem, other, renames, rename, type],
  );
  const accept = async (): Promise<void> => {
    const edits = isSystem
      ? SYSTEM.flatMap((key) => difference(at(before, [key]), at(draft, [key]), [key])).map((each) =>
          asTyped(each, typed.current),
        )
      : [
          ...(other === null ? [] : difference(at(data, other), aside, other)).map((each) =>
            asTyped(each, typed.current),
          ),
          ...changes(path, before, draft, renames, typed.current),
        ];
    const close = closing();
    if (await edit(isSystem ? "change the system" : `change ${name}`, edits)) close();
  };
  const isNamed = path.length > 1;
  const title = isSystem ? "System" : `${NOUNS[section] ?? "Entry"} ${isNamed ? String(path[1]) : ""}`.trim();
  const file = fileOf(path);
  return (
    <Window
      title={title}
      wide
      onClose={dismiss}
      onSubmit={accept}
      foot={
        <>
          <span className="hint" aria-hidden="true">
            {hint}
          </span>
          {file === undefined ? null : (
            <button type="button" onClick={() => void goIn(file)}>
              Open its canvas
            </button>
          )}
          <Foot word="OK" disabled={Object.values(renames).includes("")} />
        </>
      }
    >
      <Form.Provider value={context}>
        {isSystem || !isNamed ? null : (
          <TextRow
            title="Name"
            text={name}
            onFocus={() => setHint("Renaming it changes all that refers to it.")}
            onChange={(text) => rename(path, text)}
          />
        )}
        {isSystem ? <SystemForm value={draft} onChange={setDraft} entry={entry} /> : null}
        {section === "bodies" ? <BodyForm value={draft} onChange={setDraft} path={path} entry={entry} /> : null}
        {isGround ? <GravityForm value={aside} onChange={setAside} /> : null}
        {diagram === null ? null : <DiagramForm value={draft} onChange={setDraft} path={path} />}
        {isSystem || section === "bodies" || diagram !== null ? null : (
          <EntryForm section={section} value={draft} onChange={setDraft} path={path} />
        )}
        {other?.[0] === "switches" ? <SwitchForm value={aside} onChange={setAside} path={other} /> : null}
        <Help path={path} value={isMap(draft) ? draft : {}} />
      </Form.Provider>
    </Window>
  );
}
