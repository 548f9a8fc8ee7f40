import { useState } from "react";

import { Foot } from "../shell/Foot";
import { TextRow } from "../shell/Row";
import { Window } from "../shell/Window";
import { savePart } from "../store/clipboard";
import { closing, dismiss, useStore } from "../store/store";

/** Keeps bodies as a part of the user's library. */
export function PartForm({ bodies }: { bodies: string[] }) {
  const parts = useStore((state) => state.parts);
  const [name, setName] = useState(bodies[0] ?? "part");
  const exists = parts.some((part) => part.name === name.trim());
  const accept = async (): Promise<void> => {
    const close = closing();
    if (await savePart(name.trim(), bodies)) close();
  };
  return (
    <Window
      title="Save as a part"
      onClose={dismiss}
      onSubmit={accept}
      foot={<Foot word={exists ? "Replace" : "Save"} disabled={name.trim() === ""} />}
    >
      <div className="rows">
        <span className="quiet">Keeps {bodies.join(", ")}, with the parameters and inputs that its formulas name.</span>
        <TextRow title="Name" text={name} onChange={setName} />
      </div>
    </Window>
  );
}
