import { ReactFlowProvider } from "@xyflow/react";
import { type DragEvent, useEffect } from "react";

import { Canvas } from "./canvas/Canvas";
import { DiagramCanvas } from "./canvas/DiagramCanvas";
import { IMPORTED } from "./files/choose";
import { Bottom } from "./panels/Bottom";
import { Right } from "./panels/Right";
import { Banners, Notices } from "./shell/Banners";
import { Boundary } from "./shell/Boundary";
import { DiagramPalette } from "./shell/DiagramPalette";
import { Palette } from "./shell/Palette";
import { onKey } from "./shell/shortcuts";
import { ContextMenu } from "./shell/ContextMenu";
import { Status } from "./shell/Status";
import { Toolbar } from "./shell/Toolbar";
import { TourPane } from "./shell/TourPane";
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
  const document = useDocument();
  const { name, dirty, path, diagram } = document;
  const isDiagram = diagram !== null;
  useEffect(() => {
    window.document.title = `${dirty ? "• " : ""}${name} - SYMOFROS`;
  }, [name, dirty]);
  const right = useStore((state) => state.right);
  const bottom = useStore((state) => state.bottom);
  const dialog = useStore((state) => state.dialog);
  return (
    <ReactFlowProvider>
      <div className="page" onDrop={dropFile} onDragOver={(event) => event.preventDefault()}>
        <Banners />
        <Boundary what="The tool bar" attempt={document}>
          <Toolbar />
        </Boundary>
        <div className="middle">
          <Boundary what="The palette" attempt={document}>
            {isDiagram ? <DiagramPalette /> : <Palette />}
          </Boundary>
          <main className="work" aria-label="Diagram">
            <Boundary what="The diagram" attempt={document}>
              {isDiagram ? <DiagramCanvas key={path} /> : <Canvas key={path} />}
            </Boundary>
            {bottom === null ? null : <Bottom current={bottom} />}
          </main>
          {right === null ? null : <Right current={right} />}
        </div>
        <Status />
      </div>
      <Boundary what="The window" attempt={dialog}>
        <Dialogs />
      </Boundary>
      <Boundary what="The menu" attempt={document}>
        <ContextMenu />
      </Boundary>
      <TourPane />
      <Notices />
    </ReactFlowProvider>
  );
}

/** What is shown while there is no document: why, and a way on. */
function Waiting() {
  const link = useStore((state) => state.link);
  const isRefused = useStore((state) => state.notices.length > 0);
  return (
    <main className="waiting">
      {link === "ok" ? <p role="status">{isRefused ? "The document could not be loaded." : "Loading…"}</p> : null}
      {isRefused ? (
        <button type="button" onClick={() => window.location.reload()}>
          Reload the page
        </button>
      ) : null}
      <Banners />
      <Notices />
    </main>
  );
}

export function App() {
  useEffect(() => {
    window.addEventListener("keydown", onKey);
    return () => window.removeEventListener("keydown", onKey);
  }, []);
  const document = useStore((state) => state.document);
  return (
    <Boundary what="The page" attempt={document}>
      {document === null ? <Waiting /> : <Editor />}
    </Boundary>
  );
}
