import { ReactFlowProvider } from "@xyflow/react";
import { type DragEvent, useEffect } from "react";

import { Canvas } from "./canvas/Canvas";
import { DiagramCanvas } from "./canvas/DiagramCanvas";
import { IMPORTED } from "./files/choose";
import { Bottom } from "./panels/Bottom";
import { Right } from "./panels/Right";
import { Banners, Notices } from "./shell/Banners";
import { DiagramPalette } from "./shell/DiagramPalette";
import { Palette } from "./shell/Palette";
import { onKey } from "./shell/shortcuts";
import { Status } from "./shell/Status";
import { Toolbar } from "./shell/Toolbar";
import { importFile } from "./store/files";
import { useDocument, useStore } from "./store/store";
import { Dialogs } from "./windows/Dialogs";

/** Files dropped anywhere are imported. */
function dropFile(event: DragEvent): void {
  const file = [...event.dataTransfer.files].find(({ name }) =>
    IMPORTED.some((suffix) => name.toLowerCase().endsWith(suffix)),
  );
  if (event.dataTransfer.files.length > 0) event.preventDefault();
  if (file !== undefined) void importFile(file);
}

function Editor() {
  const { name, dirty, path, diagram } = useDocument();
  const isDiagram = diagram !== null;
  useEffect(() => {
    window.document.title = `${dirty ? "• " : ""}${name} - SYMOFROS`;
  }, [name, dirty]);
  const right = useStore((state) => state.right);
  const bottom = useStore((state) => state.bottom);
  return (
    <ReactFlowProvider>
      <div className="page" onDrop={dropFile} onDragOver={(event) => event.preventDefault()}>
        <Banners />
        <Toolbar />
        <div className="middle">
          {isDiagram ? <DiagramPalette /> : <Palette />}
          <main className="work" aria-label="Diagram">
            {isDiagram ? <DiagramCanvas key={path} /> : <Canvas key={path} />}
            {bottom === null ? null : <Bottom current={bottom} />}
          </main>
          {right === null ? null : <Right current={right} />}
        </div>
        <Status />
      </div>
      <Dialogs />
      <Notices />
    </ReactFlowProvider>
  );
}

/** What is shown while there is no document: why. */
function Waiting() {
  const link = useStore((state) => state.link);
  return (
    <main className="waiting">
      {link === "ok" ? <p role="status">Loading…</p> : null}
      <Banners />
    </main>
  );
}

export function App() {
  const hasDocument = useStore((state) => state.document !== null);
  useEffect(() => {
    window.addEventListener("keydown", onKey);
    return () => window.removeEventListener("keydown", onKey);
  }, []);
  return hasDocument ? <Editor /> : <Waiting />;
}
