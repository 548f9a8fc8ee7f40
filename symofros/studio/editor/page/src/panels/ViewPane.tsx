import { useEffect, useState } from "react";

import type { Coordinate, Fault, View } from "../api/types";
import { badge } from "../model/bending";
import { startTexts } from "../model/motion";
import { allFrames } from "../model/names";
import { expected } from "../model/pose";
import { scaleBar } from "../model/scale";
import { askedSimulation, keepSimulation, showSimulation } from "../store/asked";
import { setTime } from "../store/playing";
import { now, update, useDocument, useStore } from "../store/store";
import { useTheme } from "../store/theme";
import { look, lookAway, move, shownBlock } from "../store/view";
import { ParameterSlider } from "./ParameterSlider";

const STEPS = 500;
const MOST_EXAGGERATION = 50;
const DIGITS = 3;

const digits = (value: number): string => String(Number(value.toPrecision(DIGITS)));

interface SlideProps {
  name: string;
  unit: string;
  low: number;
  high: number;
  value: number;
  move(value: number): void;
}

/** One slider between its limits. It stands where it is held, otherwise where it was put or the view stands. */
function Slide({ name, unit, low, high, value, move }: SlideProps) {
  const [dragged, setDragged] = useState<number | null>(null);
  const finish = (): void => setDragged(null);
  const at = dragged ?? value;
  return (
    <div className="slide">
      <span className="slide-name" title={name}>
        {name}
      </span>
      <span className="slide-limit">{digits(low)}</span>
      <input
        type="range"
        min={low}
        max={high}
        step={(high - low) / STEPS || "any"}
        value={at}
        aria-label={unit === "" ? name : `${name} [${unit}]`}
        onChange={(event) => {
          const next = Number(event.target.value);
          setDragged(next);
          move(next);
        }}
        onPointerUp={finish}
        onPointerCancel={finish}
        onKeyUp={finish}
        onBlur={finish}
      />
      <span className="slide-limit">{digits(high)}</span>
      <output>
        {digits(at)} {unit}
      </output>
    </div>
  );
}

function Coordinates({ view, chosen }: { view: View; chosen: Coordinate[] }) {
  return chosen.map((one) => (
    <Slide
      key={one.name}
      {...one}
      value={view.q[one.name] ?? 0}
      move={(value) => void move({ q: { [one.name]: value } })}
    />
  ));
}

/** What the theory of beams errs in the pose, not in its exaggerated picture; a sentence from a per cent on. */
function Bending({ view }: { view: View }) {
  const known = view.beams.filter((bent) => badge(bent) !== "");
  const far = known.filter(({ grade }) => grade !== "fine");
  if (known.length === 0) return null;
  return (
    <div className="bending" role="group" aria-label="Theory of the beams">
      <p className="quiet">Error of the theory: {known.map((bent) => `${bent.beam} ${badge(bent)}`).join(", ")}</p>
      {far.map(({ beam, text, remedy, grade }) => (
        <p key={beam} className={grade} title={remedy}>
          {text}
        </p>
      ))}
    </div>
  );
}

// A loop that is open by more is none that rounding or the drift of a run leaves open.
const OPEN = 1e-6;

/** Whether loops are closed, or how far they are open. */
function Loops({ view }: { view: View }) {
  const stuck = useStore((state) => state.stuck);
  const { gap, gap_unit: unit } = view;
  const isOpen = gap !== null && gap > OPEN;
  const said =
    gap === null
      ? ""
      : isOpen
        ? `A loop is open by ${digits(gap)} ${unit}`
        : `Loops closed within ${gap.toExponential(0)} ${unit}`;
  return (
    <span role="status" className={stuck !== "" || isOpen ? "bad" : "quiet"}>
      {stuck !== "" ? "The loops can't be closed there." : said}
    </span>
  );
}

/** A frame with a handle in the picture: dragged by it, the mechanism follows as near as it gets. */
function Dragged() {
  const { data, diagram } = useDocument();
  const [frame, setFrame] = useState("");
  const frames = allFrames(data);
  const isThere = frames.includes(frame);
  const shown = isThere ? frame : "";
  useEffect(() => void move({ drag: shown }), [shown]);
  if (diagram !== null) return null;
  return (
    <label className="dragged" title="Arrows at this frame: drag them, and the joints follow by inverse kinematics">
      Drag{" "}
      <select value={shown} onChange={({ target }) => setFrame(target.value)}>
        <option value="">no frame</option>
        {frames.map((name) => (
          <option key={name}>{name}</option>
        ))}
      </select>
    </label>
  );
}

/** Opens the window of simulations, with the pose that is shown as the start. */
function StartHere({ view }: { view: View }) {
  const { data, diagram } = useDocument();
  if (diagram !== null) return null;
  const open = (): void => {
    keepSimulation({ ...askedSimulation(), q0: startTexts(data, view.q) });
    showSimulation();
  };
  const isPosing = useStore(({ posing }) => Object.keys(posing.q ?? {}).length > 0);
  const isClosed = view.gap === null || view.gap <= OPEN;
  return (
    <button
      type="button"
      className="small"
      disabled={!isClosed || isPosing}
      title="Simulate from the pose that is shown: its coordinates are the starts"
      onClick={open}
    >
      Start here…
    </button>
  );
}

/** Shows or hides the arrows, at the time that is shown. */
function showForces(forces: boolean): void {
  const { time } = now();
  void move({ forces, moments: forces });
  if (time !== null) setTime(time);
}

/** Sliders of the coordinates, of how much bending is exaggerated, of parameters. */
function Controls({ view }: { view: View }) {
  const { parameters } = useDocument();
  const put = expected(
    view,
    useStore(({ posing }) => posing),
  );
  const movable = parameters.filter(({ name, number }) => number !== null && view.run_time.includes(name));
  const elastic = view.coordinates.filter((one) => one.elastic);
  return (
    <div className="view-controls" role="group" aria-label="Pose">
      <div className="view-line">
        <button type="button" className="small" onClick={() => void move({ reset: true })}>
          Reset
        </button>
        <label>
          <input
            type="checkbox"
            checked={put.frames}
            onChange={({ target }) => void move({ frames: target.checked, labels: target.checked })}
          />{" "}
          Frames
        </label>
        <label title="Forces and moments at joints, constraints and contacts of the newest simulation, as arrows">
          <input type="checkbox" checked={put.forces} onChange={({ target }) => showForces(target.checked)} /> Forces
        </label>
        <Dragged />
        <StartHere view={view} />
        <Loops view={view} />
      </div>
      {view.legend.map((line) => (
        <p key={line} className="quiet">
          {line}
        </p>
      ))}
      <Bending view={view} />
      <Coordinates view={put} chosen={view.coordinates.filter((one) => !one.elastic)} />
      {view.flexible ? (
        <>
          <Slide
            name="exaggeration"
            unit=""
            low={0}
            high={MOST_EXAGGERATION}
            value={put.exaggeration}
            move={(exaggeration) => void move({ exaggeration })}
          />
          <details>
            <summary>Elastic coordinates</summary>
            <Coordinates view={put} chosen={elastic} />
          </details>
        </>
      ) : null}
      {movable.length === 0 ? null : (
        <details>
          <summary>Parameters</summary>
          {movable.map((parameter) => (
            <div key={parameter.name} className="slide of-parameter">
              <span className="slide-name" title={parameter.name}>
                {parameter.name}
              </span>
              <ParameterSlider parameter={parameter} />
              <output>
                {digits(parameter.number ?? 0)} {parameter.unit}
              </output>
            </div>
          ))}
        </details>
      )}
    </div>
  );
}

function Why({ fault }: { fault: Fault }) {
  return (
    <div className="pane" role="status">
      <p>
        {fault.object}: {fault.found}
      </p>
      <p className="quiet">{fault.remedy}</p>
    </div>
  );
}

/** Which mechanism of a diagram is shown, where several move. */
function Mechanism() {
  const moving = useDocument().diagram?.moving ?? [];
  useStore((state) => state.block);
  if (moving.length < 2) return null;
  return (
    <label className="view-line">
      Mechanism{" "}
      <select value={shownBlock()} onChange={(event) => update({ block: event.target.value })}>
        {moving.map((each) => (
          <option key={each}>{each}</option>
        ))}
      </select>
    </label>
  );
}

/** A bar of a round length at the depth of what the camera looks at; it follows the zoom. */
function Scale({ height }: { height: number | null }) {
  const bar = height === null ? null : scaleBar(height);
  if (bar === null) return null;
  return (
    <div className="scale" style={{ width: `${100 * bar.share}cqh` }} role="img" aria-label={`Scale: ${bar.text}`}>
      {bar.text}
    </div>
  );
}

/** The mechanism in three dimensions. The page in the frame is viser's, kept apart from this one. */
export function ViewPane() {
  const { revision, path, diagram } = useDocument();
  const view = useStore((state) => state.view);
  const block = useStore((state) => state.block);
  // A server that was gone knows nothing of the view.
  const isLinked = useStore(({ link }) => link === "ok");
  useEffect(() => lookAway, [isLinked]);
  useEffect(() => {
    if (isLinked) void look();
  }, [isLinked, revision, path, block]);
  const theme = useTheme();
  const isShown = view !== null && "address" in view;
  useEffect(() => {
    if (isShown) void move({ dark: theme === "dark" });
  }, [isShown, theme]);
  useEffect(() => {
    const { time } = now();
    if (isShown && time !== null) setTime(time);
  }, [isShown]);
  const selected = useStore((state) => state.selected);
  useEffect(() => {
    if (isShown) void move({ marked: diagram === null ? selected : [] });
  }, [isShown, selected, diagram === null]);
  if (view === null) return <p className="pane quiet">Deriving the picture…</p>;
  if (!("address" in view)) return <Why fault={view} />;
  return (
    <div className="view-pane">
      <Mechanism />
      {view.fault === null ? null : (
        <p className="view-stale" role="status">
          The last model without problems is shown: {view.fault.object}.
        </p>
      )}
      <div className="picture">
        <iframe className="view" src={view.address} title="3-D view" sandbox="allow-scripts" />
        <Scale height={view.height} />
      </div>
      <Controls view={view} />
    </div>
  );
}
