import { useUpdateNodeInternals } from "@xyflow/react";
import { useEffect, useRef } from "react";

/** Has React Flow measure a block's ports anew when `ports`, what says which it has and where, changes. */
export function usePorts(id: string, ports: unknown): void {
  const measure = useUpdateNodeInternals();
  const stated = JSON.stringify(ports);
  // A new block is measured anyway; once more for each of hundreds would take seconds.
  const measured = useRef(stated);
  useEffect(() => {
    if (measured.current === stated) return;
    measured.current = stated;
    measure(id);
  }, [measure, id, stated]);
}
