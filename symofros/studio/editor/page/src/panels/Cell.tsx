import { useState } from "react";

interface CellProps {
  value: string;
  label: string;
  commit(text: string): void;
  numeric?: boolean;
  /** Id of a list of what is usual. */
  list?: string;
  /** What is wrong with the value; "" if nothing. */
  fault?: string;
}

/** A field that changes the document when it is left, or at Enter; Escape takes it back. */
export function Cell({ value, label, commit, numeric = false, list, fault = "" }: CellProps) {
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
      aria-invalid={fault !== "" && text === null}
      title={fault !== "" && text === null ? fault : (text ?? value)}
      list={list}
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
