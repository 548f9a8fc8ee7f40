import { lazy, Suspense, useState } from "react";

import { IconButton } from "../shell/IconButton";
import { Splitter } from "../shell/Splitter";
import { type Tab, Tabs } from "../shell/Tabs";
import { type RightPane, update, useStore } from "../store/store";
import { Inputs } from "./Inputs";
import { Parameters } from "./Parameters";

const TextPane = lazy(() => import("../text/TextPane"));

/** Parameters, the text of the file, the 3-D view. */
export function Right({ current }: { current: RightPane }) {
  const view = useStore((state) => state.catalogue?.view ?? null);
  const [width, setWidth] = useState(400);
  const tabs: Tab<RightPane>[] = [
    { key: "parameters", title: "Parameters" },
    { key: "text", title: "YAML" },
    ...(view === null ? [] : [{ key: "view" as const, title: "3-D" }]),
  ];
  return (
    <aside className="side-dock" style={{ width }} aria-label="Side pane">
      <Splitter side="right" label="Width of the side pane" size={width} onChange={setWidth} />
      <Tabs tabs={tabs} current={current} onChange={(key) => update({ right: key })} label="Side pane">
        {current === "parameters" ? (
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
        {current === "view" && view !== null ? <iframe className="view" src={view} title="3-D view" /> : null}
      </Tabs>
      <IconButton glyph="close" label="Close the side pane" onClick={() => update({ right: null })} />
    </aside>
  );
}
