import { useUnsent } from "./useUnsent";

interface CellProps {
  value: string;
  label: string;
  /** Changes the document; true once it is changed. */
  commit(text: string): Promise<boolean>;
  numeric?: boolean;
  /** Id of a list of what is usual. */
  list?: string;
  /** What is wrong with the value; "" if nothing. */
  fault?: string;
}

/** A field that changes the document when it is left, or at Enter; Escape takes it back. */
export function Cell({ value, label, commit, numeric = false, list, fault = "" }: CellProps) {
  const { typed: text, type, send, isSettled, waits } = useUnsent(value, commit);
  const wrong = fault !== "" && text === null;
  const title = waits ? `Not sent: the server does not answer. ${text} is sent when it is back.` : (text ?? value);
  return (
    <input
      className={`cell${numeric ? " number" : ""}${waits ? " waits" : ""}`}
      value={text ?? value}
      aria-label={label}
      aria-invalid={wrong || waits}
      title={wrong ? fault : title}
      list={list}
      size={Math.max(3, (text ?? value).length)}
      spellCheck={false}
      data-settled={isSettled}
      onChange={(event) => type(event.target.value)}
      onBlur={() => void send()}
      onKeyDown={(event) => {
        if (event.key === "Enter") void send();
        if (event.key === "Escape") type(null);
      }}
    />
  );
}
