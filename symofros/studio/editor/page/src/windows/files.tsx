import { type ReactNode, useState } from "react";

import type { FileEntry } from "../api/types";
import { Foot } from "../shell/Foot";
import { Row, TextRow } from "../shell/Row";
import { Window } from "../shell/Window";
import { setText } from "../store/edits";
import { begin, importPath, open, save } from "../store/files";
import { closing, dismiss, now, show, useDocument } from "../store/store";

const isModel = (path: string): boolean => /\.ya?ml$/.test(path);

/** Files of other formats become documents of their own. */
const take = (path: string): Promise<void> => (isModel(path) ? open(path) : importPath(path));

export function OpenFile({ files }: { files: FileEntry[] }) {
  const [filter, setFilter] = useState("");
  const found = files.filter(({ path }) => path.toLowerCase().includes(filter.toLowerCase()));
  return (
    <Window
      title="Open"
      onClose={dismiss}
      onSubmit={() => {
        const first = found[0];
        return first === undefined ? undefined : take(first.path);
      }}
    >
      <input
        value={filter}
        placeholder="filter"
        aria-label="Filter files"
        onChange={(event) => setFilter(event.target.value)}
      />
      <ul className="files">
        {found.map(({ path, bytes, kind }) => (
          <li key={path}>
            <button type="button" onClick={() => void take(path)}>
              <span>{path}</span>
              <span className="quiet">
                {kind === "diagram" ? "diagram, " : ""}
                {Math.ceil(bytes / 1024)} KiB
              </span>
            </button>
          </li>
        ))}
      </ul>
      {found.length === 0 ? <p className="quiet">No model files here.</p> : null}
    </Window>
  );
}

/** Asks for the name of a file in the workspace. */
function AskPath({
  title,
  word,
  start,
  onDone,
  children,
}: {
  title: string;
  word: string;
  start: string;
  onDone(path: string): Promise<void>;
  children?: ReactNode;
}) {
  const [path, setPath] = useState(start);
  const full = isModel(path.trim()) ? path.trim() : `${path.trim()}.yaml`;
  return (
    <Window
      title={title}
      onClose={dismiss}
      onSubmit={() => onDone(full)}
      foot={<Foot word={word} disabled={path.trim() === ""} />}
    >
      <TextRow title="File" text={path} onChange={setPath} />
      {children}
    </Window>
  );
}

export function NewFile() {
  const [kind, setKind] = useState<"mechanism" | "diagram">("mechanism");
  return (
    <AskPath title="New document" word="Create" start="" onDone={(path) => begin(path, kind)}>
      <Row title="Kind">
        {(id) => (
          <select id={id} value={kind} onChange={(event) => setKind(event.target.value as typeof kind)}>
            <option value="mechanism">mechanism: bodies on joints</option>
            <option value="diagram">diagram: blocks and signals</option>
          </select>
        )}
      </Row>
    </AskPath>
  );
}

export function SaveAs() {
  const { path } = useDocument();
  const done = async (to: string): Promise<void> => {
    const close = closing();
    // A conflict opens a window of its own.
    if (await save(to)) close();
  };
  return <AskPath title="Save as" word="Save" start={path} onDone={done} />;
}

export function Discard({ proceed }: { proceed(): void }) {
  const { path } = useDocument();
  const first = async (): Promise<void> => {
    const close = closing();
    if ((await save()) && close()) proceed();
  };
  return (
    <Window
      title="Unsaved changes"
      onClose={dismiss}
      foot={
        <>
          <button type="button" onClick={dismiss}>
            Cancel
          </button>
          <button type="button" onClick={proceed}>
            Discard
          </button>
          <button type="button" className="primary" onClick={() => void first()}>
            Save
          </button>
        </>
      }
    >
      <p>{path} has changes that are not saved.</p>
    </Window>
  );
}

/** A text; lines that the other one lacks are marked. */
function Marked({ title, text, other }: { title: string; text: string; other: string }) {
  const known = new Set(other.split("\n"));
  return (
    <section aria-label={title}>
      <h3>{title}</h3>
      <pre tabIndex={0}>
        {text.split("\n").map((line, i) => (known.has(line) ? `${line}\n` : <mark key={i}>{`${line}\n`}</mark>))}
      </pre>
    </section>
  );
}

/** The file is not as it was when it was opened: both texts, and who wins. */
export function ChangedOnDisk({ disk, over, path }: { disk: string; over: string; path: string | null }) {
  const { text } = useDocument();
  const [shown] = useState(text);
  const overwrite = async (): Promise<void> => {
    const close = closing();
    if (await save(path, over)) close();
  };
  const takeTheirs = async (): Promise<void> => {
    const close = closing();
    if (await setText(disk, shown)) close();
  };
  return (
    <Window
      title="The file has changed on disk"
      wide
      onClose={dismiss}
      foot={
        <>
          <button type="button" onClick={dismiss}>
            Cancel
          </button>
          <button type="button" onClick={() => show({ kind: "save as" })}>
            Save as…
          </button>
          <button type="button" onClick={() => void takeTheirs()}>
            Take the text on disk
          </button>
          <button type="button" className="danger" onClick={() => void overwrite()}>
            Overwrite it
          </button>
        </>
      }
    >
      <p>Somebody else wrote {path ?? now().document?.path}. Taking that text can be undone; overwriting it cannot.</p>
      <div className="two-texts">
        <Marked title="On disk" text={disk} other={shown} />
        <Marked title="Here" text={shown} other={disk} />
      </div>
    </Window>
  );
}
