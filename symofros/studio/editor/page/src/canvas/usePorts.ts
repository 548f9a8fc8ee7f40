import { useUpdateNodeInternals } from "@xyflow/react";
import { useEffect } from "react";

/** Has React Flow measure a block's ports anew when `ports`, what says which it has and where, changes. */
export function usePorts(id: string, ports: unknown): void {
  const measure = useUpdateNodeInternals();
  const stated = JSON.stringify(ports);
  useEffect(() => measure(id), [measure, id, stated]);
}
