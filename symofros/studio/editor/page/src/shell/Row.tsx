import { type ReactNode, useId } from "react";

interface RowProps {
  title: string;
  unit?: string;
  /** The field, which takes the given id. */
  children(id: string): ReactNode;
}

/** A line of a form: name, field, unit. */
export function Row({ title, unit, children }: RowProps) {
  const id = useId();
  return (
    <div className="row">
      <label className="row-label" htmlFor={id}>
        {title}
      </label>
      <div className="row-control">{children(id)}</div>
      {unit === undefined ? null : <span className="row-unit">{unit}</span>}
    </div>
  );
}

interface TextRowProps {
  title: string;
  text: string;
  onChange(text: string): void;
  onFocus?: () => void;
}

export function TextRow({ title, text, onChange, onFocus }: TextRowProps) {
  return (
    <Row title={title}>
      {(id) => (
        <input
          id={id}
          value={text}
          spellCheck={false}
          onFocus={onFocus}
          onChange={(event) => onChange(event.target.value)}
        />
      )}
    </Row>
  );
}
