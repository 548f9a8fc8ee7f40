import type { Problem } from "../api/types";
import { SYSTEM } from "../model/sections";
import { reveal } from "../store/folding";
import { show, update, useDocument } from "../store/store";
import { Glyph } from "../shell/Glyph";

/** Moves the block into sight, and opens its window. */
function go({ node, path }: Problem): void {
  if (node !== "") reveal(node);
  const [section, name] = path;
  if (section === "parameters" || section === "inputs") update({ right: "parameters" });
  else if (section === "simulation" || section === "wires") update({ right: "text" });
  else if (SYSTEM.includes(String(section))) show({ kind: "properties", path: ["system"] });
  else if (path.length >= 2 && section !== undefined && name !== undefined)
    show({ kind: "properties", path: [section, name], entry: path.slice(2) });
  else update({ right: "text" });
}

/** What is wrong with the document, in four parts each. */
export function Problems() {
  const { problems, diagram } = useDocument();
  if (problems.length === 0)
    return (
      <p className="pane quiet">No problems: the {diagram === null ? "model can be compiled" : "diagram can run"}.</p>
    );
  return (
    <ul className="pane problems">
      {problems.map((problem, i) => (
        <li key={i}>
          <button type="button" onClick={() => go(problem)}>
            <Glyph name="warning" size={14} />
            <span>
              <b>{problem.object}</b>
              {problem.line > 0 ? <span className="quiet"> line {problem.line}</span> : null}
              <br />
              found: {problem.found}; rule: {problem.rule}
              <br />
              <span className="remedy">{problem.remedy}</span>
            </span>
          </button>
        </li>
      ))}
    </ul>
  );
}
