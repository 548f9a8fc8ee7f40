import { Glyph } from "./Glyph";

interface Props {
  glyph: string;
  label: string;
  onClick(): void;
  disabled?: boolean;
  pressed?: boolean;
}

export function IconButton({ glyph, label, onClick, disabled = false, pressed }: Props) {
  return (
    <button
      type="button"
      className="icon"
      aria-label={label}
      title={label}
      disabled={disabled}
      aria-pressed={pressed}
      onClick={onClick}
    >
      <Glyph name={glyph} />
    </button>
  );
}
