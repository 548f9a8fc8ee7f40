import { useState } from "react";

import type { JsonMap, Path } from "../api/types";
import { definition, field, label } from "../forms/schema";
import { isMap, textAt } from "../model/paths";
import { useStore } from "../store/store";

/** What a window is about: the records of the schema that it shows, and the page of the documentation. */
interface Topic {
  names: readonly string[];
  page: string;
}

const OF_SECTION: Record<string, Topic> = {
  bodies: { names: ["BodyEntry", "JointEntry", "InertiaEntry", "SolidEntry", "FrameEntry"], page: "docs/yaml.md" },
  closures: { names: ["ClosureEntry", "AnchorEntry"], page: "docs/howto/closed_loops.md" },
  connections: { names: ["ConnectionEntry", "AnchorEntry"], page: "docs/yaml.md" },
  contacts: { names: ["ContactEntry", "AnchorEntry"], page: "docs/theory/rigid.md" },
  nonholonomic: { names: ["NonholonomicEntry", "KnifeEdgeEntry", "RollingEntry"], page: "docs/yaml.md" },
  system: { names: ["SystemEntry", "SwitchEntry"], page: "docs/yaml.md" },
  models: { names: [], page: "docs/diagrams.md, The file" },
  parts: { names: ["part"], page: "docs/diagrams.md, The file" },
  simulation: { names: [], page: "docs/diagrams.md, The file" },
  wires: { names: [], page: "docs/diagrams.md, The file" },
};

const BEAM: Topic = { names: ["BeamEntry", "SectionEntry", "JointEntry", "FrameEntry"], page: "docs/theory/beams.md" };

/** The class of a kind of blocks, by which the documentation calls it. */
const className = (kind: string): string =>
  kind
    .split("_")
    .map((word) => word.charAt(0).toUpperCase() + word.slice(1))
    .join("")
    .replace(/^Lqr$/, "LQR")
    .replace(/Pd$/, "PD")
    .replace(/Pid$/, "PID");

function topicOf(path: Path, value: JsonMap): Topic {
  const section = String(path[0]);
  const kind = textAt(value, ["kind"]) ?? "";
  if (section === "blocks") return { names: [kind], page: `docs/blocks.md, ${className(kind)}` };
  if (section === "bodies" && isMap(value["beam"])) return BEAM;
  return OF_SECTION[section] ?? { names: [], page: "docs/yaml.md" };
}

/** Where the documentation says more. */
export function DocsPage({ page }: { page: string }) {
  return (
    <p className="quiet docs-page">
      In the documentation: <b>{page}</b>
    </p>
  );
}

/** One record of the schema: what it is, then each of its fields. */
function Record({ root, name }: { root: JsonMap; name: string }) {
  const { shape, help } = definition(root, name);
  if (shape.kind !== "record") return null;
  const fields = Object.entries(shape.properties).flatMap(([key, schema]) => {
    const described = isMap(schema) ? field(root, schema).help : "";
    return described === "" ? [] : [{ key, described }];
  });
  return (
    <section>
      {help === "" ? null : <p>{help}</p>}
      <dl>
        {fields.map(({ key, described }) => (
          <div key={key}>
            <dt>
              {label(key, name)} <code>{key}</code>
            </dt>
            <dd>{described}</dd>
          </div>
        ))}
      </dl>
    </section>
  );
}

/** The help of a window, folded until it is asked for. */
export function Help({ path, value }: { path: Path; value: JsonMap }) {
  const catalogue = useStore((state) => state.catalogue);
  const isDiagram = useStore((state) => state.document?.diagram !== null);
  const [open, setOpen] = useState(false);
  const { names, page } = topicOf(path, value);
  const root = (isDiagram ? catalogue?.diagram.schema : catalogue?.schema) ?? {};
  const about = catalogue?.diagram.palette.find((each) => each.kind === textAt(value, ["kind"]))?.about;
  return (
    <details className="help" open={open} onToggle={(event) => setOpen(event.currentTarget.open)}>
      <summary>Help</summary>
      {open ? (
        <div className="help-text" tabIndex={0} role="region" aria-label="Help">
          {about?.split(/\n{2,}/).map((paragraph) => (
            <p key={paragraph}>{paragraph.replaceAll(/\s+/g, " ")}</p>
          ))}
          {names.map((name) => (
            <Record key={name} root={root} name={name} />
          ))}
          <DocsPage page={page} />
        </div>
      ) : null}
    </details>
  );
}
