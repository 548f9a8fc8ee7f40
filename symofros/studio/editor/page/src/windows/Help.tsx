import { useState } from "react";

import { get } from "../api/client";
import type { BlockItem, JsonMap, Path } from "../api/types";
import { definition, field, label } from "../forms/schema";
import { isMap, textAt } from "../model/paths";
import { ordered } from "../store/requests";
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
  contacts: { names: ["ContactEntry", "AnchorEntry"], page: "docs/howto/contact.md" },
  nonholonomic: { names: ["NonholonomicEntry", "KnifeEdgeEntry", "RollingEntry"], page: "docs/yaml.md" },
  system: { names: ["SystemEntry", "SwitchEntry"], page: "docs/yaml.md" },
  models: { names: [], page: "docs/diagrams.md, The file" },
  parts: { names: ["part"], page: "docs/diagrams.md, The file" },
  simulation: { names: [], page: "docs/diagrams.md, The file" },
  wires: { names: [], page: "docs/diagrams.md, The file" },
};

const BEAM: Topic = { names: ["BeamEntry", "SectionEntry", "JointEntry", "FrameEntry"], page: "docs/theory/beams.md" };

function topicOf(path: Path, value: JsonMap, block: BlockItem | undefined): Topic {
  const section = String(path[0]);
  if (section === "blocks") return { names: [textAt(value, ["kind"]) ?? ""], page: block?.page ?? "docs/blocks.md" };
  if (section === "bodies" && isMap(value["beam"])) return BEAM;
  return OF_SECTION[section] ?? { names: [], page: "docs/yaml.md" };
}

/** Where the documentation says more: a page, and after a comma a section of it, which is read here. */
export function DocsPage({ page }: { page: string }) {
  const [shown, setShown] = useState({ page: "", text: "" });
  const read = (): void =>
    void ordered(() => get<{ text: string }>(`api/docs?page=${encodeURIComponent(page)}`)).then(
      (answer) => answer !== undefined && setShown({ page, text: answer.text }),
    );
  return (
    <details className="docs-page" key={page} onToggle={({ currentTarget }) => currentTarget.open && read()}>
      <summary className="quiet">
        In the documentation: <b>{page}</b>
      </summary>
      <pre tabIndex={0} role="region" aria-label={page}>
        {shown.page === page ? shown.text : ""}
      </pre>
    </details>
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
              {label(key, name) === key ? null : label(key, name)} <code>{key}</code>
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
  const block = catalogue?.diagram.palette.find((each) => each.kind === textAt(value, ["kind"]));
  const { names, page } = topicOf(path, value, block);
  const root = (isDiagram ? catalogue?.diagram.schema : catalogue?.schema) ?? {};
  return (
    <details className="help" open={open} onToggle={(event) => setOpen(event.currentTarget.open)}>
      <summary>Help</summary>
      {open ? (
        <div className="help-text" tabIndex={0} role="region" aria-label="Help">
          {block?.about?.split(/\n{2,}/).map((paragraph) => (
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
