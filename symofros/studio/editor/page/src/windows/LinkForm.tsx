import { Window } from "../shell/Window";
import { Glyph } from "../shell/Glyph";
import { join, type Join } from "../store/bodies";
import { DocsPage } from "./Help";
import { type Anchor, dismiss } from "../store/store";

const KINDS: readonly { kind: Join; glyph: string; title: string; help: string }[] = [
  { kind: "closure", glyph: "closure", title: "Closure", help: "the two frames stay together: a loop is closed" },
  { kind: "rod", glyph: "rod", title: "Rod", help: "massless; the origins stay at a distance" },
  { kind: "spring", glyph: "spring", title: "Spring and damper", help: "a force along the line between the origins" },
];

const words = ({ body, frame }: Anchor): string => (frame === "" ? body : `${body}.${frame}`);

/** What joins two frames. */
export function LinkForm({ first, second }: { first: Anchor; second: Anchor }) {
  return (
    <Window title={`Join ${words(first)} and ${words(second)}`} onClose={dismiss}>
      <div className="picks">
        {KINDS.map(({ kind, glyph, title, help }) => (
          <button
            key={kind}
            type="button"
            onClick={() => {
              dismiss();
              void join(kind, first, second);
            }}
          >
            <Glyph name={glyph} size={20} />
            <span>
              <b>{title}</b>
              <br />
              <span className="quiet">{help}</span>
            </span>
          </button>
        ))}
      </div>
      <DocsPage page="docs/howto/closed_loops.md" />
    </Window>
  );
}
