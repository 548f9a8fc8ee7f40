import { dismiss } from "../store/store";

interface Props {
  word: string;
  disabled?: boolean;
  onCancel?: () => void;
}

/** Buttons of a window: give up, or accept by what `word` says. */
export function Foot({ word, disabled = false, onCancel = dismiss }: Props) {
  return (
    <>
      <button type="button" onClick={onCancel}>
        Cancel
      </button>
      <button type="submit" className="primary" disabled={disabled}>
        {word}
      </button>
    </>
  );
}
