import { cancel } from "../store/jobs";
import { useDocument, useStore } from "../store/store";

/** One line: the model's size, what runs. */
export function Status() {
  const { graph, diagram, parameters } = useDocument();
  const jobs = useStore((state) => state.jobs);
  const version = useStore((state) => state.catalogue?.version);
  const running = Object.values(jobs).find((job) => job.state === "running");
  const bodies = graph.nodes.filter((node) => node.id.startsWith("bodies/")).length;
  const blocks = diagram?.nodes.filter((node) => node.id.startsWith("blocks/")).length ?? 0;
  const loops = graph.edges.filter((edge) => edge.kind === "closure").length;
  return (
    <footer className="status">
      <span>
        {diagram === null
          ? `bodies ${bodies} · closures ${loops} · parameters ${parameters.length}`
          : `models ${Object.keys(diagram.models).length} · blocks ${blocks} · wires ${diagram.wires.length}`}
      </span>
      {running === undefined ? null : (
        <span className="working">
          <progress
            max={running.progress.total || 1}
            value={running.progress.total > 0 ? running.progress.done : undefined}
            aria-label={`${running.kind}: progress`}
          />
          <span className="doing">{running.progress.text || running.kind}</span>
          <button type="button" className="small" onClick={() => void cancel(running.kind)}>
            Cancel
          </button>
        </span>
      )}
      <span className="quiet">{version === undefined ? "" : `symofros ${version}`}</span>
    </footer>
  );
}
