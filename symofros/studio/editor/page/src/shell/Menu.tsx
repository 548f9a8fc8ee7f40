import { type KeyboardEvent, useCallback, useEffect, useId, useRef, useState } from "react";

export interface MenuItem {
  title: string;
  keys?: string;
  act(): void;
  disabled?: boolean;
}

const CHOICES = "[role=menuitem]:not(:disabled)";

interface ListProps {
  id?: string;
  title: string;
  items: readonly MenuItem[];
  /** Something was chosen, given up, or pressed elsewhere. */
  close(why: "done" | "elsewhere"): void;
}

/** A list of commands: arrows move in it, Escape closes it, so does a press elsewhere. */
export function MenuList({ id, title, items, close }: ListProps) {
  const list = useRef<HTMLDivElement>(null);
  useEffect(() => {
    list.current?.querySelector<HTMLElement>(CHOICES)?.focus();
    const elsewhere = (event: PointerEvent): void => {
      if (!list.current?.parentElement?.contains(event.target as Node)) close("elsewhere");
    };
    window.addEventListener("pointerdown", elsewhere, true);
    return () => window.removeEventListener("pointerdown", elsewhere, true);
  }, [close]);
  const go = (event: KeyboardEvent): void => {
    event.stopPropagation();
    if (event.key === "Escape") close("done");
    const step = event.key === "ArrowDown" ? 1 : event.key === "ArrowUp" ? -1 : 0;
    if (step === 0) return;
    event.preventDefault();
    const all = [...(list.current?.querySelectorAll<HTMLElement>(CHOICES) ?? [])];
    const place = all.indexOf(window.document.activeElement as HTMLElement);
    all[(place + step + all.length) % all.length]?.focus();
  };
  return (
    <div id={id} ref={list} role="menu" aria-label={title} className="menu-list" onKeyDown={go}>
      {items.map((item) => (
        <button
          key={item.title}
          type="button"
          role="menuitem"
          disabled={item.disabled}
          onClick={() => {
            close("done");
            item.act();
          }}
        >
          <span>{item.title}</span>
          {item.keys === undefined ? null : <kbd>{item.keys}</kbd>}
        </button>
      ))}
    </div>
  );
}

/** A button that opens a list of commands. */
export function Menu({ title, items }: { title: string; items: readonly MenuItem[] }) {
  const [open, setOpen] = useState(false);
  const button = useRef<HTMLButtonElement>(null);
  const id = useId();
  const close = useCallback((why: "done" | "elsewhere"): void => {
    setOpen(false);
    if (why === "done") button.current?.focus();
  }, []);
  return (
    <div className="menu">
      <button
        ref={button}
        type="button"
        aria-haspopup="menu"
        aria-expanded={open}
        aria-controls={open ? id : undefined}
        onClick={() => setOpen(!open)}
      >
        {title}
      </button>
      {open ? <MenuList id={id} title={title} items={items} close={close} /> : null}
    </div>
  );
}
