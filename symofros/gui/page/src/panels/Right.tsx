import { lazy, type PointerEvent, Suspense, useState } from "react";

import { IconButton } from "../shell/IconButton";
import { type Tab, Tabs } from "../shell/Tabs";
import { type RightPane, update, useStore } from "../store/store";
import { Inputs } from "./Inputs";
import { Parameters } from "./Parameters";

const TextPane = lazy(() => import("../text/TextPane"));

const LEAST = 280;

/** The line between canvas and pane, to be dragged; arrows move it too. */
function Splitter({ width, onChange }: { width: number; onChange(width: number): void }) {
  const clamp = (wanted: number): void => onChange(Math.min(Math.max(wanted, LEAST), window.innerWidth - 500));
  const follow = (event: PointerEvent<HTMLDivElement>): void => {
    if (event.currentTarget.hasPointerCapture(event.pointerId)) clamp(window.innerWidth - event.clientX);
  };
  return (
    <div
      className="splitter"
      role="separator"
      aria-orientation="vertical"
      aria-label="Width of the side pane"
      aria-valuenow={width}
      aria-valuemin={LEAST}
      aria-valuemax={window.innerWidth - 500}
      tabIndex={0}
      onPointerDown={(event) => event.currentTarget.setPointerCapture(event.pointerId)}
      onPointerMove={follow}
      onKeyDown={(event) => {
        if (event.key === "ArrowLeft") clamp(width + 20);
        if (event.key === "ArrowRight") clamp(width - 20);
      }}
    />
  );
}

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
      <Splitter width={width} onChange={setWidth} />
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
