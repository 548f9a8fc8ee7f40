import type { PointerEvent } from "react";

const STEP = 20;

interface Props {
  /** The edge of the page that the pane is at. */
  side: "right" | "bottom";
  label: string;
  size: number;
  onChange(size: number): void;
}

const LEAST = { right: 280, bottom: 120 };
// What is left for the diagram.
const REST = { right: 500, bottom: 260 };

/** The line between the diagram and a pane, to be dragged; arrows move it too. */
export function Splitter({ side, label, size, onChange }: Props) {
  const extent = side === "right" ? window.innerWidth : window.innerHeight;
  const most = extent - REST[side];
  const clamp = (wanted: number): void => onChange(Math.min(Math.max(wanted, LEAST[side]), most));
  const follow = (event: PointerEvent<HTMLDivElement>): void => {
    if (!event.currentTarget.hasPointerCapture(event.pointerId)) return;
    // Measured from the pane's far edge, which stays.
    const box = event.currentTarget.parentElement?.getBoundingClientRect();
    if (box !== undefined) clamp(side === "right" ? box.right - event.clientX : box.bottom - event.clientY);
  };
  const [grow, shrink] = side === "right" ? ["ArrowLeft", "ArrowRight"] : ["ArrowUp", "ArrowDown"];
  return (
    <div
      className={`splitter ${side}`}
      role="separator"
      aria-orientation={side === "right" ? "vertical" : "horizontal"}
      aria-label={label}
      aria-valuenow={size}
      aria-valuemin={LEAST[side]}
      aria-valuemax={most}
      tabIndex={0}
      onPointerDown={(event) => event.currentTarget.setPointerCapture(event.pointerId)}
      onPointerMove={follow}
      onKeyDown={(event) => {
        if (event.key === grow) clamp(size + STEP);
        if (event.key === shrink) clamp(size - STEP);
      }}
    />
  );
}
