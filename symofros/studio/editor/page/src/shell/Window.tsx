import { type FormEvent, type ReactNode, useId, useLayoutEffect, useRef } from "react";

import { IconButton } from "./IconButton";

interface Props {
  title: string;
  children: ReactNode;
  /** Buttons at the foot. */
  foot?: ReactNode;
  onClose(): void;
  /** Until what it promises has come, no other Enter or click submits. */
  onSubmit?: () => void | Promise<void>;
  wide?: boolean;
}

/** A modal window. The browser's own dialog holds the focus inside, and gives it back when it closes. */
export function Window({ title, children, foot, onClose, onSubmit, wide = false }: Props) {
  const dialog = useRef<HTMLDialogElement>(null);
  const id = useId();
  // Before it leaves the page: only then the browser knows what had the focus.
  useLayoutEffect(() => {
    const element = dialog.current;
    element?.showModal();
    // The browser would choose the button that closes it.
    const field = ":is(input, select, textarea, button)";
    const first =
      element?.querySelector<HTMLElement>(`[data-first] ${field}`) ??
      element?.querySelector<HTMLElement>(`.window-body ${field}`);
    first?.focus();
    if (first instanceof HTMLInputElement) first.select();
    return () => element?.close();
  }, []);
  const isBusy = useRef(false);
  const submit = async (event: FormEvent): Promise<void> => {
    event.preventDefault();
    if (isBusy.current) return;
    isBusy.current = true;
    try {
      await onSubmit?.();
    } finally {
      isBusy.current = false;
    }
  };
  return (
    <dialog
      ref={dialog}
      className={wide ? "window wide" : "window"}
      aria-labelledby={id}
      onCancel={(event) => {
        event.preventDefault();
        onClose();
      }}
    >
      <form method="dialog" noValidate onSubmit={(event) => void submit(event)}>
        <div className="window-head">
          <h2 id={id}>{title}</h2>
          <IconButton glyph="close" label="Close" onClick={onClose} />
        </div>
        <div className="window-body">{children}</div>
        {foot === undefined ? null : <div className="window-foot">{foot}</div>}
      </form>
    </dialog>
  );
}
