import { useState } from "react";

import type { JobKind, Ran } from "../api/jobs";
import type { KeptRun } from "../model/runs";
import { draw, forget, rename, saveFilm, saveTable } from "../store/runs";
import { useDocument, useStore } from "../store/store";

/** Whether a mechanism moves in it. */
const moves = ({ kind, result }: KeptRun): boolean =>
  kind === "simulate" || Object.keys((result as Ran).motions).length > 0;

/** Draws the motion as a film; that takes seconds. */
function Film({ run }: { run: KeptRun }) {
  const [drawing, setDrawing] = useState(false);
  const draw = async (suffix: "gif" | "mp4"): Promise<void> => {
    setDrawing(true);
    await saveFilm(run, suffix);
    setDrawing(false);
  };
  return (["gif", "mp4"] as const).map((suffix) => (
    <button
      key={suffix}
      type="button"
      className="small"
      disabled={drawing}
      aria-label={`Film of ${run.name}, ${suffix.toUpperCase()}`}
      title="A film at the speed it plays, with time and exaggeration written on it"
      onClick={() => void draw(suffix)}
    >
      {drawing ? "Drawing…" : suffix.toUpperCase()}
    </button>
  ));
}

/** The kept runs of a kind: their names, which are drawn with the newest, and their files. */
export function Runs({ kind }: { kind: JobKind }) {
  const { revision } = useDocument();
  const runs = useStore((state) => state.runs);
  const newest = useStore((state) => state.jobs[kind]?.id);
  const kept = runs.filter((run) => run.kind === kind);
  if (kept.length === 0) return null;
  return (
    <ul className="runs" aria-label="Kept runs">
      {kept.map((run) => (
        <li key={run.id}>
          <input
            type="checkbox"
            aria-label={`Draw ${run.name}`}
            checked={run.shown || run.id === newest}
            disabled={run.id === newest}
            onChange={(event) => draw(run.id, event.target.checked)}
          />
          <input
            className="run-name"
            aria-label={`Name of ${run.name}`}
            value={run.name}
            maxLength={60}
            onChange={(event) => rename(run.id, event.target.value)}
          />
          {run.revision === revision ? null : (
            <span className="past-mark" title="The document has changed since">
              outdated
            </span>
          )}
          <button type="button" className="small" onClick={() => void saveTable(run, "csv")}>
            CSV
          </button>
          <button type="button" className="small" onClick={() => void saveTable(run, "parquet")}>
            Parquet
          </button>
          {moves(run) && run.revision === revision ? <Film run={run} /> : null}
          {run.id === newest ? null : (
            <button type="button" className="small" aria-label={`Forget ${run.name}`} onClick={() => forget(run.id)}>
              Forget
            </button>
          )}
        </li>
      ))}
    </ul>
  );
}
