import { useState } from "react";

import type { BlockItem } from "../api/types";
import { addBlock } from "../store/diagram";
import { useStore } from "../store/store";
import { Entry } from "./Palette";

/** What a diagram is made of: the library of blocks, by its groups. */
export function DiagramPalette() {
  const catalogue = useStore((state) => state.catalogue?.diagram);
  const [filter, setFilter] = useState("");
  const [closed, setClosed] = useState<readonly string[]>(["generic", "network"]);
  const words = filter.toLowerCase().split(/\s+/).filter(Boolean);
  const isMeant = ({ title, help }: BlockItem): boolean =>
    words.every((word) => `${title} ${help}`.toLowerCase().includes(word));
  const items = catalogue?.palette.filter(isMeant) ?? [];
  return (
    <nav className="palette" aria-label="Palette">
      <input
        className="palette-filter"
        value={filter}
        placeholder="find a block"
        aria-label="Find a block"
        spellCheck={false}
        onChange={(event) => setFilter(event.target.value)}
      />
      {catalogue?.groups.map(({ key, title }) => {
        const own = items.filter(({ group }) => group === key);
        const isOpen = words.length > 0 || !closed.includes(key);
        if (own.length === 0) return null;
        return (
          <section key={key} aria-label={title}>
            <h2>
              <button
                type="button"
                className="fold"
                aria-expanded={isOpen}
                onClick={() => setClosed(isOpen ? [...closed, key] : closed.filter((each) => each !== key))}
              >
                {title}
              </button>
            </h2>
            {isOpen
              ? own.map((item) => (
                  <Entry
                    key={item.kind}
                    glyph={key}
                    title={item.title}
                    help={item.help}
                    word={item.kind}
                    draggable
                    onAdd={() => void addBlock(item)}
                  />
                ))
              : null}
          </section>
        );
      })}
    </nav>
  );
}
