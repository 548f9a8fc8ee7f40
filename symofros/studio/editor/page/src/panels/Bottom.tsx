import { useState } from "react";

import type {
  Analysed as AnalysedResult,
  Compiled as CompiledResult,
  Crosschecked as CrosscheckedResult,
  Exported,
  InPage,
  Job,
  JobKind,
  Ran,
  Simulated,
} from "../api/jobs";
import { Boundary } from "../shell/Boundary";
import { Glyph } from "../shell/Glyph";
import { IconButton } from "../shell/IconButton";
import { Splitter } from "../shell/Splitter";
import { type Tab, Tabs } from "../shell/Tabs";
import { cancel, order } from "../store/jobs";
import { type BottomPane, update, useBegun, useDocument, useStore } from "../store/store";
import { Analysed } from "./Analysed";
import { Compiled } from "./Compiled";
import { Crosschecked } from "./Crosschecked";
import { Problems } from "./Problems";
import { LiveRun, Run } from "./Run";
import { Simulation } from "./Simulation";

const TITLES: Record<JobKind, string> = {
  compile: "Operations",
  crosscheck: "Cross-check",
  simulate: "Simulation",
  analyse: "Analysis",
  page: "In this page",
  export: "Export",
  run: "Run",
};

/** Pause, go on, end with what there is. */
function Orders({ job }: { job: Job }) {
  const isPaused = job.progress.paused === true;
  return (
    <>
      <button type="button" className="small" onClick={() => void order(job.kind, isPaused ? "resume" : "pause")}>
        {isPaused ? "Go on" : "Pause"}
      </button>
      <button type="button" className="small" onClick={() => void order(job.kind, "stop")}>
        Stop
      </button>
    </>
  );
}

/** Samples of this run so far. */
const useLive = (job: Job) => useStore(({ live }) => (live?.id === job.id ? live : null));

function RunningDiagram({ job }: { job: Job }) {
  const live = useLive(job);
  return (
    <>
      <Running job={job} />
      {live === null ? null : <LiveRun live={live} />}
    </>
  );
}

function Running({ job }: { job: Job }) {
  const { done, total, text } = job.progress;
  const live = useLive(job);
  const hasBegun = job.progress.paused === true || (live !== null && live.t.length > 0);
  return (
    <div className="running" role="status">
      <progress max={total || 1} value={total > 0 ? done : undefined} aria-label={TITLES[job.kind]} />
      <span>{text || "starting"}</span>
      {job.kind === "run" && hasBegun ? <Orders job={job} /> : null}
      <button type="button" className="small" onClick={() => void cancel(job.kind)}>
        Cancel
      </button>
    </div>
  );
}

function Result({ job }: { job: Job }) {
  switch (job.kind) {
    case "compile":
      return <Compiled result={job.result as CompiledResult} />;
    case "crosscheck":
      return <Crosschecked result={job.result as CrosscheckedResult} />;
    case "simulate":
      return <Simulation result={job.result as Simulated} />;
    case "analyse":
      return <Analysed result={job.result as AnalysedResult} />;
    case "page":
      return (
        <iframe
          className="in-page"
          title="The mechanism, simulated in this page"
          src={(job.result as InPage).address}
          sandbox="allow-scripts"
        />
      );
    case "run":
      return <Run result={job.result as Ran} />;
    case "export":
      return (
        <ul className="results">
          {[
            ...(job.result as Exported).files.map((file) => <code key={file}>{file}</code>),
            ...(job.result as Exported).notes,
          ].map((line, i) => (
            <li key={i}>{line}</li>
          ))}
        </ul>
      );
  }
}

/** Results of a model that has changed since say so, and are shown as what they are: past. */
function Past({ job }: { job: Job }) {
  return (
    <>
      <p className="pane past" role="status">
        <Glyph name="warning" size={14} /> The {job.kind === "run" ? "diagram" : "model"} has changed since:{" "}
        {TITLES[job.kind].toLowerCase()} of an earlier state. Run it again.
      </p>
      <div className="past-result">
        <Result job={job} />
      </div>
    </>
  );
}

function Outcome({ job }: { job: Job }) {
  const { revision } = useDocument();
  if (job.state === "running") return job.kind === "run" ? <RunningDiagram job={job} /> : <Running job={job} />;
  if (job.state === "cancelled") return <p className="pane quiet">Cancelled.</p>;
  if (job.state === "done") return job.revision === revision ? <Result job={job} /> : <Past job={job} />;
  return (
    <div className="pane fault" role="alert">
      <p>
        <Glyph name="warning" size={14} /> <b>{job.error?.object}</b>
      </p>
      <dl>
        {(["found", "rule", "remedy"] as const).map((key) => (
          <div key={key}>
            <dt>{key}</dt>
            <dd>{job.error?.[key]}</dd>
          </div>
        ))}
      </dl>
    </div>
  );
}

/** Problems, and what the jobs returned. */
export function Bottom({ current }: { current: BottomPane }) {
  const jobs = useStore((state) => state.jobs);
  const { problems, path, revision } = useDocument();
  const begun = useBegun();
  const [height, setHeight] = useState(() => Math.round(window.innerHeight * 0.42));
  const tabs: Tab<BottomPane>[] = [
    {
      key: "problems",
      title: (
        <>
          Problems
          {problems.length > 0 ? <span className={begun ? "count" : "count calm"}>{problems.length}</span> : null}
        </>
      ),
    },
    ...(Object.keys(TITLES) as JobKind[])
      .filter((kind) => jobs[kind] !== undefined)
      .map((kind) => ({ key: kind, title: TITLES[kind] })),
  ];
  const job = current === "problems" ? undefined : jobs[current];
  return (
    <section className="result-dock" style={{ height }} aria-label="Results">
      <Splitter side="bottom" label="Height of the results" size={height} onChange={setHeight} />
      <Tabs
        tabs={tabs}
        current={job === undefined ? "problems" : current}
        onChange={(key) => update({ bottom: key })}
        label="Results"
      >
        <Boundary what="The result" attempt={`${current} ${path} ${revision} ${job?.id} ${job?.state}`}>
          {job === undefined ? <Problems /> : <Outcome key={job.id} job={job} />}
        </Boundary>
      </Tabs>
      <IconButton glyph="close" label="Close the results" onClick={() => update({ bottom: null })} />
    </section>
  );
}
