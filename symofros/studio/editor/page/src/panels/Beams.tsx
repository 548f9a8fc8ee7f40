import type { BentBeam } from "../api/jobs";
import { percent, rough, where } from "../model/bending";

const WORDS = { fine: "good", noted: "noted", beyond: "beyond the theory" };

/** What the theory of each beam errs where it errs most. */
export function Beams({ beams }: { beams: readonly BentBeam[] }) {
  if (beams.length === 0) return null;
  return (
    <table className="figures beams">
      <caption className="quiet">Beams where their theory errs most</caption>
      <thead>
        <tr>
          <th scope="col">Beam</th>
          <th scope="col">Slope [rad]</th>
          <th scope="col">Where</th>
          <th scope="col">Estimated error</th>
          <th scope="col">Verdict</th>
        </tr>
      </thead>
      <tbody>
        {beams.map((bent) => (
          <tr key={bent.beam} title={bent.grade === "fine" ? bent.text : `${bent.text}; ${bent.remedy}`}>
            <th scope="row">{bent.beam}</th>
            <td>{bent.slope === null ? "not finite" : rough(bent.slope)}</td>
            <td className="word">{where(bent)}</td>
            <td>
              {percent(bent.error)}
              {bent.error === null ? "" : bent.exact ? " of its length" : " of its deflection"}
            </td>
            <td className={`word ${bent.grade === "beyond" ? "bad" : bent.grade === "fine" ? "good" : ""}`}>
              {WORDS[bent.grade]}
            </td>
          </tr>
        ))}
      </tbody>
    </table>
  );
}
