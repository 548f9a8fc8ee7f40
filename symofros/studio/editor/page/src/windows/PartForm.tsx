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
      foot={<Foot word="Save" disabled={exists || name.trim() === ""} />}
    >
      <div className="rows">
        <span className="quiet">
          Keeps {bodies.join(", ")}, what joins them to each other and to the ground, and the parameters and inputs that
          their formulas name.
        </span>
        <TextRow title="Name" text={name} onChange={setName} />
        {exists ? (
          <span className="quiet">There is a part of that name already; it is kept. Choose another.</span>
        ) : null}
      </div>
    </Window>
  );
}
