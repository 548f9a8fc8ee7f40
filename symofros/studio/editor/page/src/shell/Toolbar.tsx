import { useReactFlow } from "@xyflow/react";

import type { JobKind } from "../api/jobs";
import { pace, whole } from "../canvas/useSight";
import { chooseImport } from "../files/choose";
import { savePicture } from "../files/picture";
import { toRedo, toUndo } from "../model/moves";
import { tidyDiagram } from "../model/diagram_layout";
import { tidy } from "../model/layout";
import { showAnalysis, showSimulation } from "../store/asked";
import { copy, cut, duplicate, paste } from "../store/clipboard";
import { moveBlocks, redo, undo } from "../store/edits";
import { remove } from "../store/elements";
import { browse, browseExamples, leave, save } from "../store/files";
import { run } from "../store/jobs";
import { beginTour } from "../store/tour";
import { now, show, update, useBegun, useDocument, useStore } from "../store/store";
import { toggleTheme } from "../store/theme";
import { IconButton } from "./IconButton";
import { Menu } from "./Menu";

function FileMenu() {
  const document = useDocument();
  return (
    <Menu
      title="File"
      items={[
        { title: "New…", act: () => show({ kind: "new" }) },
        { title: "Examples…", act: () => void browseExamples() },
        { title: "Tour: five steps to a motion", act: beginTour },
        { title: "Open…", keys: "Ctrl O", act: () => void browse() },
        { title: "Save", keys: "Ctrl S", act: () => void save() },
        { title: "Save as…", keys: "Ctrl Shift S", act: () => show({ kind: "save as" }) },
        { title: "Import URDF, MJCF, YAML…", act: () => void chooseImport() },
        ...(document.diagram === null
          ? [
              { title: "Picture of the diagram, SVG", act: () => void savePicture(document, "svg") },
              { title: "Picture of the diagram, PNG", act: () => void savePicture(document, "png") },
            ]
          : []),
      ]}
    />
  );
}

function EditMenu() {
  const isDiagram = useDocument().diagram !== null;
  return (
    <Menu
      title="Edit"
      items={[
        { title: "Cut", keys: "Ctrl X", act: cut },
        { title: "Copy", keys: "Ctrl C", act: copy },
        { title: "Paste", keys: "Ctrl V", act: () => void paste() },
        { title: "Duplicate", keys: "Ctrl D", act: () => void duplicate() },
        { title: "Remove", keys: "Delete", act: () => void remove(now().selected) },
        { title: "Find…", keys: "Ctrl K", act: () => show({ kind: "search" }) },
        ...(isDiagram
          ? [{ title: "Simulation: end, step, plots…", act: () => show({ kind: "properties", path: ["simulation"] }) }]
          : [
              {
                title: "System: gravity, virtual power, couplings…",
                act: () => show({ kind: "properties", path: ["system"] }),
              },
            ]),
        { title: "Keys", keys: "?", act: () => show({ kind: "keys" }) },
      ]}
    />
  );
}

interface Command {
  kind: JobKind;
  title: string;
  help: string;
  start(): void;
}

const OF_DIAGRAM: readonly Command[] = [
  {
    kind: "run",
    title: "Run",
    help: "Run the diagram as its file says: compiled, to its end",
    start: () => void run("run"),
  },
  {
    kind: "run",
    title: "Run…",
    help: "Compiled or block by block, to when, at what pace, with stops",
    start: () => show({ kind: "run" }),
  },
  {
    kind: "export",
    title: "Export…",
    help: "A C program that runs the diagram",
    start: () => show({ kind: "export" }),
  },
];

const OF_MECHANISM: readonly Command[] = [
  {
    kind: "compile",
    title: "Compile",
    help: "Derive the equations, generate and compile C",
    start: () => void run("compile"),
  },
  {
    kind: "crosscheck",
    title: "Cross-check",
    help: "Compare the model with independent engines",
    start: () => void run("crosscheck"),
  },
  { kind: "simulate", title: "Simulate…", help: "Integrate the motion", start: showSimulation },
  {
    kind: "analyse",
    title: "Analyse…",
    help: "Equilibrium, vibration modes, linear model",
    start: showAnalysis,
  },
  {
    kind: "export",
    title: "Export…",
    help: "C package, FMU, MEX and other formats",
    start: () => show({ kind: "export" }),
  },
];

function Work() {
  const { problems, diagram } = useDocument();
  const begun = useBegun();
  const jobs = useStore((state) => state.jobs);
  const count = problems.length;
  return (
    <div className="cluster" role="group" aria-label={diagram === null ? "Model" : "Diagram"}>
      <button
        type="button"
        className={count === 0 ? "check good" : begun ? "check bad" : "check"}
        onClick={() => update({ bottom: now().bottom === "problems" ? null : "problems" })}
      >
        {count === 0 ? "No problems" : `${count} problem${count > 1 ? "s" : ""}`}
      </button>
      {(diagram === null ? OF_MECHANISM : OF_DIAGRAM).map(({ kind, title, help, start }) => (
        <button
          key={title}
          type="button"
          title={help}
          disabled={count > 0 || jobs[kind]?.state === "running"}
          onClick={start}
        >
          {title}
        </button>
      ))}
    </div>
  );
}

/** Commands, from the file at the left to the model at the right. */
export function Toolbar() {
  const document = useDocument();
  const flow = useReactFlow();
  const right = useStore((state) => state.right);
  const moves = useStore((state) => state.moves);
  const undoable = toUndo(moves, document.step)?.label ?? (document.can_undo ? (document.undo_label ?? "") : null);
  const redoable = toRedo(moves, document.step)?.label ?? (document.can_redo ? (document.redo_label ?? "") : null);
  const arrange = async (): Promise<void> => {
    await moveBlocks(document.diagram === null ? tidy(document.graph) : tidyDiagram(document.diagram));
    requestAnimationFrame(() => void flow.fitView({ ...whole(), duration: pace() }));
  };
  return (
    <header className="toolbar">
      <FileMenu />
      <EditMenu />
      <div className="cluster" role="group" aria-label="Diagram">
        <IconButton
          glyph="undo"
          label={undoable === null ? "Undo" : `Undo: ${undoable} (Ctrl Z)`}
          disabled={undoable === null}
          onClick={() => void undo()}
        />
        <IconButton
          glyph="redo"
          label={redoable === null ? "Redo" : `Redo: ${redoable} (Ctrl Y)`}
          disabled={redoable === null}
          onClick={() => void redo()}
        />
        <IconButton glyph="layout" label="Arrange the blocks" onClick={() => void arrange()} />
        <IconButton
          glyph="fit"
          label="Show the whole diagram"
          onClick={() => void flow.fitView({ ...whole(), duration: pace() })}
        />
        <IconButton glyph="search" label="Find (Ctrl K)" onClick={() => show({ kind: "search" })} />
      </div>
      <h1 className="file-name" title={document.path}>
        {document.trail.length > 0 ? (
          <button
            type="button"
            className="small trail"
            title="Back to the diagram (Alt ←)"
            onClick={() => void leave()}
          >
            ← {document.trail.join(" › ")}
          </button>
        ) : null}
        <span className="file-path">{document.path}</span>
        {document.dirty ? <span className="dirty">unsaved</span> : null}
      </h1>
      <Work />
      <div className="cluster">
        <button
          type="button"
          aria-pressed={right === "text"}
          onClick={() => update({ right: right === "text" ? "parameters" : "text" })}
        >
          YAML
        </button>
        <button
          type="button"
          aria-pressed={right === "view"}
          onClick={() => update({ right: right === "view" ? "parameters" : "view" })}
        >
          3-D
        </button>
        <IconButton glyph="theme" label="Dark or light" onClick={toggleTheme} />
      </div>
    </header>
  );
}
