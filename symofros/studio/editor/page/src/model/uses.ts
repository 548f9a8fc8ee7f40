/** What refers to a body, and cannot be without it. */

import type { Json, JsonMap, Path } from "../api/types";
import { isMap, mapAt } from "./paths";

const SECTIONS = ["closures", "connections", "contacts", "nonholonomic"] as const;

function mentions(value: Json, body: string): boolean {
  if (!isMap(value)) return false;
  return value["body"] === body || Object.values(value).some((item) => mentions(item, body));
}

/** Paths of the closures, connections, contacts and conditions on a body. */
export function usesOf(data: JsonMap, body: string): Path[] {
  return SECTIONS.flatMap((section) =>
    Object.entries(mapAt(data, [section]))
      .filter(([, value]) => mentions(value, body))
      .map(([name]) => [section, name]),
  );
}
