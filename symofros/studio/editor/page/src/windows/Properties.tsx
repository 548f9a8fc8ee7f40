import { useCallback, useMemo, useRef, useState } from "react";

import type { Json, Path } from "../api/types";
import { Form, type FormContext } from "../forms/context";
import { asTyped, changes, keyOf, type Renames } from "../model/changes";
import { at, difference } from "../model/paths";
import { Foot } from "../shell/Foot";
import { TextRow } from "../shell/Row";
import { Window } from "../shell/Window";
import { edit } from "../store/edits";
import { dismiss, useDocument, useStore } from "../store/store";
import { BodyForm } from "./BodyForm";
import { EntryForm } from "./EntryForm";
import { SystemForm } from "./SystemForm";

const NOUNS: Record<string, string> = {
  bodies: "Body",
  closures: "Closure",
  connections: "Connection",
  nonholonomic: "Condition",
};

/** What the system window shows: all that concerns no single block. */
const SYSTEM = ["system", "virtual_power", "potentials"] as const;

/** The window of a block, a link or the whole system. Nothing is changed until it is accepted, as one step of undo. */
export function Properties({ path, entry }: { path: Path; entry: Path }) {
  const document = useDocument();
  const schema = useStore((state) => state.catalogue?.schema);
  const isSystem = path[0] === "system";
  // What the window was opened with; changes from elsewhere do not touch what is being typed.
  const [data] = useState(document.data);
  const [before] = useState(() => (isSystem ? data : at(data, path)));
  const [draft, setDraft] = useState<Json | undefined>(before);
  const [renames, setRenames] = useState<Renames>({});
  const name = renames[keyOf(path)] ?? String(path.at(-1));
  const [hint, setHint] = useState("");
  const section = String(path[0]);
  const typed = useRef(new Map<string, string>());
  const type = useCallback((place: Path, text: string) => void typed.current.set(keyOf(place), text.trim()), []);
  const rename = useCallback(
    (place: Path, to: string) => setRenames((all) => ({ ...all, [keyOf(place)]: to.trim() })),
    [],
  );
  const context = useMemo<FormContext>(
    () => ({
      root: schema ?? {},
      data,
      body: section === "bodies" ? String(path[1]) : null,
      renames,
      rename,
      type,
      hint: setHint,
    }),
    [schema, data, section, path, renames, rename, type],
  );
  const accept = async (): Promise<void> => {
    const edits = isSystem
      ? SYSTEM.flatMap((key) => difference(at(before, [key]), at(draft, [key]), [key])).map((each) =>
          asTyped(each, typed.current),
        )
      : changes(path, before, draft, renames, typed.current);
    if (await edit(isSystem ? "change the system" : `change ${name}`, edits)) dismiss();
  };
  const title = isSystem ? "System" : `${NOUNS[section] ?? "Entry"} ${String(path[1])}`;
  return (
    <Window
      title={title}
      wide
      onClose={dismiss}
      onSubmit={() => void accept()}
      foot={
        <>
          <span className="hint" aria-hidden="true">
            {hint}
          </span>
          <Foot word="OK" disabled={Object.values(renames).includes("")} />
        </>
      }
    >
      <Form.Provider value={context}>
        {isSystem ? null : (
          <TextRow
            title="Name"
            text={name}
            onFocus={() => setHint("Renaming it changes all that refers to it.")}
            onChange={(text) => rename(path, text)}
          />
        )}
        {isSystem ? <SystemForm value={draft} onChange={setDraft} /> : null}
        {section === "bodies" ? <BodyForm value={draft} onChange={setDraft} path={path} entry={entry} /> : null}
        {isSystem || section === "bodies" ? null : (
          <EntryForm section={section} value={draft} onChange={setDraft} path={path} />
        )}
      </Form.Provider>
    </Window>
  );
}
