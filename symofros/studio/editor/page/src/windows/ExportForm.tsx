import { useState } from "react";

import { stem } from "../model/names";
import { Foot } from "../shell/Foot";
import { TextRow } from "../shell/Row";
import { Window } from "../shell/Window";
import { run } from "../store/jobs";
import { DocsPage } from "./Help";
import { dismiss, useDocument, useStore } from "../store/store";

const TITLES: Record<string, string> = {
  c: "C source package",
  cuda: "CUDA kernels",
  mex: "MEX function for MATLAB and Octave",
  sfunction: "S-function for Simulink",
  fmu2: "FMU 2.0",
  fmu3: "FMU 3.0",
  wasm: "WebAssembly, with a page that simulates",
  urdf: "URDF",
  mjcf: "MJCF (MuJoCo)",
};

/** What to write, and into which folder of the workspace. */
export function ExportForm() {
  const { name, diagram } = useDocument();
  const targets = useStore((state) => state.catalogue?.targets) ?? [];
  // A diagram becomes a program.
  const kinds = diagram === null ? targets : ["c"];
  const [kind, setKind] = useState(kinds[0] ?? "");
  const [typed, setFolder] = useState<string | null>(null);
  // Each format has a folder of its own: one export takes the place of another in none.
  const folder = typed ?? `${stem(name)}_${kind}`;
  const start = (): void => {
    dismiss();
    void run("export", { target: kind, folder });
  };
  return (
    <Window
      title="Export"
      onClose={dismiss}
      onSubmit={start}
      foot={<Foot word="Export" disabled={kind === "" || folder.trim() === ""} />}
    >
      <fieldset className="kinds">
        <legend>Format</legend>
        {kinds.map((each) => (
          <label key={each}>
            <input type="radio" name="kind" checked={kind === each} onChange={() => setKind(each)} />
            {TITLES[each] ?? each}
          </label>
        ))}
      </fieldset>
      <TextRow title="Folder" text={folder} onChange={setFolder} />
      <DocsPage page="docs/exports.md" />
    </Window>
  );
}
