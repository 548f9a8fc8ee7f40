import { type KeyboardEvent, useEffect, useId, useRef, useState } from "react";

export interface MenuItem {
  title: string;
  keys?: string;
  act(): void;
  disabled?: boolean;
}

/** A button that opens a list of commands. */
export function Menu({ title, items }: { title: string; items: readonly MenuItem[] }) {
  const [open, setOpen] = useState(false);
  const box = useRef<HTMLDivElement>(null);
  const id = useId();
  useEffect(() => {
    if (!open) return undefined;
    box.current?.querySelector<HTMLElement>("[role=menuitem]:not(:disabled)")?.focus();
    const elsewhere = (event: PointerEvent): void => {
      if (!box.current?.contains(event.target as Node)) setOpen(false);
    };
    window.addEventListener("pointerdown", elsewhere);
    return () => window.removeEventListener("pointerdown", elsewhere);
  }, [open]);
  const close = (): void => {
    setOpen(false);
    box.current?.querySelector("button")?.focus();
  };
  const go = (event: KeyboardEvent): void => {
    if (event.key === "Escape") close();
    const step = event.key === "ArrowDown" ? 1 : event.key === "ArrowUp" ? -1 : 0;
    if (step === 0) return;
    event.preventDefault();
    const all = [...(box.current?.querySelectorAll<HTMLElement>("[role=menuitem]:not(:disabled)") ?? [])];
    const place = all.indexOf(window.document.activeElement as HTMLElement);
    all[(place + step + all.length) % all.length]?.focus();
  };
  return (
    <div ref={box} className="menu" onKeyDown={go}>
      <button
        type="button"
        aria-haspopup="menu"
        aria-expanded={open}
        aria-controls={open ? id : undefined}
        onClick={() => setOpen(!open)}
      >
        {title}
      </button>
      {open ? (
        <div id={id} role="menu" aria-label={title} className="menu-list">
          {items.map((item) => (
            <button
              key={item.title}
              type="button"
              role="menuitem"
              disabled={item.disabled}
              onClick={() => {
                close();
                item.act();
              }}
            >
              <span>{item.title}</span>
              {item.keys === undefined ? null : <kbd>{item.keys}</kbd>}
            </button>
          ))}
        </div>
      ) : null}
    </div>
  );
}
