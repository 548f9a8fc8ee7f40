import { useState } from "react";

import { Window } from "../shell/Window";
import { savePart } from "../store/clipboard";
import { dismiss, useStore } from "../store/store";

/** Keeps bodies as a part of the user's library. */
export function PartForm({ bodies }: { bodies: string[] }) {
  const parts = useStore((state) => state.parts);
  const [name, setName] = useState(bodies[0] ?? "part");
  const exists = parts.some((part) => part.name === name.trim());
  const accept = async (): Promise<void> => {
    if (await savePart(name.trim(), bodies)) dismiss();
  };
  return (
    <Window
      title="Save as a part"
      onClose={dismiss}
      onSubmit={() => void accept()}
      foot={
        <>
          <button type="button" onClick={dismiss}>
            Cancel
          </button>
          <button type="submit" className="primary" disabled={name.trim() === ""}>
            {exists ? "Replace" : "Save"}
          </button>
        </>
      }
    >
      <p className="quiet">{bodies.join(", ")}, with the parameters and inputs that they use</p>
      <div className="row">
        <label className="row-label" htmlFor="part">
          Name
        </label>
        <div className="row-control">
          <input id="part" value={name} spellCheck={false} onChange={(event) => setName(event.target.value)} />
        </div>
      </div>
    </Window>
  );
}
