import { lazy, Suspense, useState } from "react";

import { Boundary } from "../shell/Boundary";
import { IconButton } from "../shell/IconButton";
import { Splitter } from "../shell/Splitter";
import { type Tab, Tabs } from "../shell/Tabs";
import { type RightPane, update, useDocument } from "../store/store";
import { Inputs } from "./Inputs";
import { Models } from "./Models";
import { Parameters } from "./Parameters";
import { Tree } from "./Tree";
import { ViewPane } from "./ViewPane";

const TextPane = lazy(() => import("../text/TextPane"));

function Pane({ current, isDiagram }: { current: RightPane; isDiagram: boolean }) {
  switch (current) {
    case "parameters":
      return isDiagram ? (
        <Models />
      ) : (
        <>
          <Parameters />
          <Inputs />
        </>
      );
    case "text":
      return (
        <Suspense fallback={<p className="pane quiet">Loading the text editor…</p>}>
          <TextPane />
        </Suspense>
      );
    case "tree":
      return <Tree />;
    case "view":
      return <ViewPane />;
  }
}

/** Parameters, the tree of elements, the text of the file, the 3-D view. */
export function Right({ current }: { current: RightPane }) {
  const [widths, setWidths] = useState({ parameters: 400, tree: 300, text: 400, view: 540, models: 272 });
  const { diagram, path, revision } = useDocument();
  const isDiagram = diagram !== null;
  const pane = isDiagram && current === "parameters" ? "models" : current;
  const width = widths[pane];
  const tabs: Tab<RightPane>[] = [
    { key: "parameters", title: isDiagram ? "Models" : "Parameters" },
    { key: "tree", title: "Tree" },
    { key: "text", title: "YAML" },
    { key: "view", title: "3-D" },
  ];
  return (
    <aside className="side-dock" style={{ width }} aria-label="Side pane">
      <Splitter
        side="right"
        label="Width of the side pane"
        size={width}
        onChange={(size) => setWidths({ ...widths, [pane]: size })}
      />
      <Tabs tabs={tabs} current={current} onChange={(key) => update({ right: key })} label="Side pane">
        <Boundary what="The pane" attempt={`${current} ${path} ${revision}`}>
          {/* What is typed in a pane is of its document: another one has panes of its own. */}
          <Pane key={path} current={current} isDiagram={isDiagram} />
        </Boundary>
      </Tabs>
      <IconButton glyph="close" label="Close the side pane" onClick={() => update({ right: null })} />
    </aside>
  );
}
