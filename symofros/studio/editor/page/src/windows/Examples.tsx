import type { Example } from "../api/types";
import { Window } from "../shell/Window";
import { takeExample } from "../store/files";
import { dismiss } from "../store/store";

const KINDS = [
  { kind: "mechanism", title: "Mechanisms" },
  { kind: "diagram", title: "Diagrams" },
] as const;

/** Models and diagrams to begin with; one that is chosen becomes a new document. */
export function Examples({ examples }: { examples: readonly Example[] }) {
  return (
    <Window title="Examples" wide onClose={dismiss}>
      {KINDS.map(({ kind, title }) => (
        <section key={kind} aria-label={title}>
          <h3>{title}</h3>
          <ul className="examples">
            {examples
              .filter((each) => each.kind === kind)
              .map(({ name, title: words, about, picture }) => (
                <li key={name}>
                  <button type="button" onClick={() => void takeExample(name)}>
                    <img src={`./examples/${picture}.png`} alt="" width={240} height={160} />
                    <b>{words}</b>
                    <span className="quiet">{about}</span>
                  </button>
                </li>
              ))}
          </ul>
        </section>
      ))}
    </Window>
  );
}
