import type { DragEvent, ReactNode } from "react";

import type { PaletteItem } from "../api/types";
import { DRAGGED } from "../canvas/Board";
import { LINKS } from "../model/sections";
import { add, selectedBodies } from "../store/bodies";
import { insertPart } from "../store/clipboard";
import { show, useStore } from "../store/store";
import { Glyph } from "./Glyph";

interface EntryProps {
  glyph: string;
  title: string;
  help: string;
  word: string;
  onAdd(): void;
  draggable: boolean;
}

/** Something to add: dragged onto the canvas, or put beside the selected block by a click or Enter. */
export function Entry({ glyph, title, help, word, onAdd, draggable }: EntryProps) {
  const begin = (event: DragEvent): void => {
    event.dataTransfer.setData(DRAGGED, word);
    event.dataTransfer.effectAllowed = "copy";
  };
  return (
    <button type="button" className="entry" title={help} draggable={draggable} onDragStart={begin} onClick={onAdd}>
      <Glyph name={glyph} />
      {title}
    </button>
  );
}

interface GroupProps {
  title: string;
  items: PaletteItem[];
  children?: ReactNode;
}

function Group({ title, items, children }: GroupProps) {
  if (items.length === 0) return null;
  return (
    <section aria-label={title}>
      <h2>{title}</h2>
      {items.map((item) => (
        <Entry
          key={item.title}
          glyph={item.kind}
          title={item.title}
          help={item.help}
          word={item.name}
          draggable={item.section === "bodies" || item.section === "nonholonomic"}
          onAdd={() => void add(item)}
        />
      ))}
      {children}
    </section>
  );
}

const NUMBERS = ["parameters", "inputs"];

/** What a mechanism is made of. */
export function Palette() {
  const items = useStore((state) => state.catalogue?.palette) ?? [];
  const parts = useStore((state) => state.parts);
  const selected = useStore((state) => state.selected);
  const of = (sections: string[]): PaletteItem[] => items.filter((item) => sections.includes(item.section));
  return (
    <nav className="palette" aria-label="Palette">
      <Group title="Bodies" items={of(["bodies"])} />
      <Group title="Constraints and links" items={of([...LINKS, "nonholonomic"])}>
        <Entry
          glyph="motor"
          title="Coupling…"
          help="A formula of coordinates that stays zero, such as q2 - 3*q1: a gear, a belt. In the window of the system."
          word=""
          draggable={false}
          onAdd={() => show({ kind: "properties", path: ["system"], entry: ["couplings"] })}
        />
      </Group>
      <Group title="Numbers" items={of(NUMBERS)} />
      <section aria-label="My parts">
        <h2>My parts</h2>
        {parts.map((part) => (
          <Entry
            key={part.name}
            glyph="part"
            title={part.name}
            help={`bodies: ${part.bodies.join(", ")}`}
            word={`part ${part.name}`}
            draggable
            onAdd={() => void insertPart(part.name)}
          />
        ))}
        <button
          type="button"
          className="entry quiet"
          disabled={!selected.some((id) => /^bodies\/[^/]+$/.test(id))}
          title="Keep the selected bodies with their parameters, to be used in other models"
          onClick={() => show({ kind: "save part", bodies: selectedBodies() })}
        >
          <Glyph name="plus" />
          Save selection…
        </button>
      </section>
    </nav>
  );
}
