import { useMemo, useState } from "react";

import type { Edit, Json, Path } from "../api/types";
import { Form, type FormContext } from "../forms/context";
import { at, difference } from "../model/paths";
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
  nonholonomic: "Condition on speeds",
};

/** Edits from a window: the new name first, then what differs, at the places under that name. */
function edits(path: Path, name: string, before: Json | undefined, after: Json | undefined): Edit[] {
  const old = path.at(-1);
  const renamed: Edit[] = path.length === 2 && name !== old ? [{ op: "rename", path, to: name }] : [];
  return [...renamed, ...difference(before, after, renamed.length > 0 ? [...path.slice(0, -1), name] : path)];
}

/** What the system window shows: all that concerns no single block. */
const SYSTEM = ["system", "virtual_power", "potentials"] as const;

/** The window of a block, a link or the whole system. Nothing is changed until it is accepted, as one step of undo. */
export function Properties({ path }: { path: Path }) {
  const document = useDocument();
  const schema = useStore((state) => state.catalogue?.schema);
  const isSystem = path[0] === "system";
  // What the window was opened with; changes from elsewhere do not touch what is being typed.
  const [data] = useState(document.data);
  const [before] = useState(() => (isSystem ? data : at(data, path)));
  const [draft, setDraft] = useState<Json | undefined>(before);
  const [name, setName] = useState(String(path.at(-1)));
  const [hint, setHint] = useState("");
  const section = String(path[0]);
  const context = useMemo<FormContext>(
    () => ({ root: schema ?? {}, data, body: section === "bodies" ? String(path[1]) : null, hint: setHint }),
    [schema, data, section, path],
  );
  const accept = async (): Promise<void> => {
    const changes = isSystem
      ? SYSTEM.flatMap((key) => difference(at(before, [key]), at(draft, [key]), [key]))
      : edits(path, name.trim(), before, draft);
    if (await edit(isSystem ? "change the system" : `change ${name}`, changes)) dismiss();
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
          <button type="button" onClick={dismiss}>
            Cancel
          </button>
          <button type="submit" className="primary" disabled={name.trim() === ""}>
            OK
          </button>
        </>
      }
    >
      <Form.Provider value={context}>
        {isSystem ? null : (
          <div className="row">
            <label className="row-label" htmlFor="entry-name">
              Name
            </label>
            <div className="row-control">
              <input id="entry-name" value={name} spellCheck={false} onFocus={() => setHint("Renaming it changes all that refers to it.")} onChange={(event) => setName(event.target.value)} />
            </div>
          </div>
        )}
        {isSystem ? <SystemForm value={draft} onChange={setDraft} /> : null}
        {section === "bodies" ? <BodyForm value={draft} onChange={setDraft} path={path} /> : null}
        {isSystem || section === "bodies" ? null : <EntryForm section={section} value={draft} onChange={setDraft} path={path} />}
      </Form.Provider>
    </Window>
  );
}
