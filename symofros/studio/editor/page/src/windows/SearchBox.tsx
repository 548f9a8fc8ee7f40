import { type KeyboardEvent, useMemo, useState } from "react";

import { everything, type Hit, search } from "../model/search";
import { Window } from "../shell/Window";
import { reveal } from "../store/folding";
import { dismiss, update, useDocument } from "../store/store";

function go({ id, name, what }: Hit): void {
  dismiss();
  if (id === "") update({ right: "parameters", filter: what === "parameter" ? name : "" });
  else reveal(id);
}

/** Goes to anything by its name. */
export function SearchBox() {
  const document = useDocument();
  const all = useMemo(() => everything(document), [document]);
  const [text, setText] = useState("");
  const [place, setPlace] = useState(0);
  const hits = search(all, text);
  const current = Math.min(place, hits.length - 1);
  const move = (event: KeyboardEvent): void => {
    const step = event.key === "ArrowDown" ? 1 : event.key === "ArrowUp" ? -1 : 0;
    if (step === 0) return;
    event.preventDefault();
    setPlace(Math.max(0, Math.min(hits.length - 1, current + step)));
  };
  const accept = (): void => {
    const hit = hits[current];
    if (hit !== undefined) go(hit);
  };
  return (
    <Window title="Find" onClose={dismiss} onSubmit={accept}>
      <input
        value={text}
        placeholder={document.diagram === null ? "body, joint, frame, parameter…" : "block, model, kind…"}

        role="combobox"
        aria-label="Find by name"
        aria-expanded
        aria-controls="hits"
        aria-activedescendant={hits.length > 0 ? `hit-${current}` : undefined}
        spellCheck={false}
        onChange={(event) => {
          setText(event.target.value);
          setPlace(0);
        }}
        onKeyDown={move}
      />
      <ul id="hits" className="files" role="listbox" aria-label="Found">
        {hits.map((hit, i) => (
          <li
            key={`${hit.what} ${hit.name}`}
            id={`hit-${i}`}
            role="option"
            aria-selected={i === current}
            onClick={() => go(hit)}
          >
            <span>{hit.name}</span>
            <span className="quiet">{hit.what}</span>
          </li>
        ))}
      </ul>
    </Window>
  );
}
