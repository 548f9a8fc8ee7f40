import { type KeyboardEvent, type ReactNode, useId } from "react";

export interface Tab<K extends string> {
  key: K;
  title: ReactNode;
}

interface Props<K extends string> {
  tabs: readonly Tab<K>[];
  current: K;
  onChange(key: K): void;
  label: string;
  children: ReactNode;
}

/** Tabs after the ARIA pattern: one of them is in the order of focus, arrows go to the others. */
export function Tabs<K extends string>({ tabs, current, onChange, label, children }: Props<K>) {
  const id = useId();
  const go = (event: KeyboardEvent, place: number): void => {
    const step = event.key === "ArrowRight" ? 1 : event.key === "ArrowLeft" ? -1 : 0;
    const next = tabs[(place + step + tabs.length) % tabs.length];
    if (step === 0 || next === undefined) return;
    event.preventDefault();
    onChange(next.key);
    window.document.getElementById(`${id}-${next.key}`)?.focus();
  };
  return (
    <div className="tabs">
      <div className="tab-list" role="tablist" aria-label={label}>
        {tabs.map((tab, i) => (
          <button
            key={tab.key}
            id={`${id}-${tab.key}`}
            type="button"
            role="tab"
            aria-selected={tab.key === current}
            aria-controls={`${id}-panel`}
            tabIndex={tab.key === current ? 0 : -1}
            onClick={() => onChange(tab.key)}
            onKeyDown={(event) => go(event, i)}
          >
            {tab.title}
          </button>
        ))}
      </div>
      <div id={`${id}-panel`} className="tab-panel" role="tabpanel" tabIndex={0} aria-labelledby={`${id}-${current}`}>
        {children}
      </div>
    </div>
  );
}
