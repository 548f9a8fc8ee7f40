import { useState } from "react";

/** A field that changes the document when it is left, or at Enter; Escape takes it back. */
export function Cell({ value, label, commit, numeric = false }: { value: string; label: string; commit(text: string): void; numeric?: boolean }) {
  const [text, setText] = useState<string | null>(null);
  const finish = (): void => {
    if (text !== null && text !== value) commit(text);
    setText(null);
  };
  return (
    <input
      className={numeric ? "cell number" : "cell"}
      value={text ?? value}
      aria-label={label}
      spellCheck={false}
      data-settled={text === null}
      onChange={(event) => setText(event.target.value)}
      onBlur={finish}
      onKeyDown={(event) => {
        if (event.key === "Enter") finish();
        if (event.key === "Escape") setText(null);
      }}
    />
  );
}
