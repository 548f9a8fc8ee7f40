import { lazy, Suspense, useState } from "react";

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

/** Parameters, the tree of elements, the text of the file, the 3-D view. */
export function Right({ current }: { current: RightPane }) {
  const [widths, setWidths] = useState({ parameters: 400, tree: 300, text: 400, view: 540, models: 272 });
  const isDiagram = useDocument().diagram !== null;
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
        {current === "parameters" && isDiagram ? <Models /> : null}
        {current === "parameters" && !isDiagram ? (
          <>
            <Parameters />
            <Inputs />
          </>
        ) : null}
        {current === "text" ? (
          <Suspense fallback={<p className="pane quiet">Loading the text editor…</p>}>
            <TextPane />
          </Suspense>
        ) : null}
        {current === "tree" ? <Tree /> : null}
        {current === "view" ? <ViewPane /> : null}
      </Tabs>
      <IconButton glyph="close" label="Close the side pane" onClick={() => update({ right: null })} />
    </aside>
  );
}
