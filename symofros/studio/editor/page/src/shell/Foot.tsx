import { dismiss } from "../store/store";

/** Buttons of a window: give up, or accept by what `word` says. */
export function Foot({ word, disabled = false }: { word: string; disabled?: boolean }) {
  return (
    <>
      <button type="button" onClick={dismiss}>
        Cancel
      </button>
      <button type="submit" className="primary" disabled={disabled}>
        {word}
      </button>
    </>
  );
}
