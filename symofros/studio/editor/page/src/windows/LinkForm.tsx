import { LINKS } from "../model/sections";
import { Window } from "../shell/Window";
import { Glyph } from "../shell/Glyph";
import { join } from "../store/bodies";
import { DocsPage } from "./Help";
import { type Anchor, dismiss, useStore } from "../store/store";

const words = ({ body, frame }: Anchor): string => (frame === "" ? body : `${body}.${frame}`);

/** What joins two frames: the links of the palette. */
export function LinkForm({ first, second }: { first: Anchor; second: Anchor }) {
  const palette = useStore((state) => state.catalogue?.palette) ?? [];
  return (
    <Window title={`Join ${words(first)} and ${words(second)}`} onClose={dismiss}>
      <div className="picks">
        {palette
          .filter(({ section }) => LINKS.includes(section))
          .map((item) => (
            <button
              key={item.title}
              type="button"
              onClick={() => {
                dismiss();
                void join(item, first, second);
              }}
            >
              <Glyph name={item.kind} size={20} />
              <span>
                <b>{item.title}</b>
                <br />
                <span className="quiet">{item.help}</span>
              </span>
            </button>
          ))}
      </div>
      <DocsPage page="docs/howto/closed_loops.md" />
    </Window>
  );
}
