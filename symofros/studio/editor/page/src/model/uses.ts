/** What refers to bodies, and cannot be without them. */

import type { Json, JsonMap, Path } from "../api/types";
import { isMap, mapAt } from "./paths";

/** Sections of what stands between bodies, or on one. */
export const LINKING = ["closures", "connections", "contacts", "nonholonomic"] as const;

/** The bodies that an entry names at its ends. */
export function bodiesIn(value: Json): string[] {
  if (!isMap(value)) return [];
  return Object.entries(value).flatMap(([key, item]) =>
    key === "body" && typeof item === "string" ? [item] : bodiesIn(item),
  );
}

/** Paths of the closures, connections, contacts and conditions on a body. */
export function usesOf(data: JsonMap, body: string): Path[] {
  return LINKING.flatMap((section) =>
    Object.entries(mapAt(data, [section]))
      .filter(([, value]) => bodiesIn(value).includes(body))
      .map(([name]) => [section, name]),
  );
}
