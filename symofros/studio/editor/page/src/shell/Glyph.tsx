import { GLYPHS } from "../model/glyphs";

/** A line drawing; it says nothing to a screen reader, so what it stands for must be said beside it. */
export function Glyph({ name, size = 16 }: { name: string; size?: number }) {
  return (
    <svg className="glyph" width={size} height={size} viewBox="0 0 16 16" aria-hidden="true" focusable="false">
      <path d={GLYPHS[name] ?? GLYPHS["rigid_body"]} />
    </svg>
  );
}
