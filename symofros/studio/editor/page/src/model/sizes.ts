/** Entries of a shape and its sizes: which are asked for, and which are left when another shape is chosen. */

import type { Json, JsonMap, Sizes } from "../api/types";
import { isMap, textAt } from "./paths";

/** The shape of an entry: of a contact its surface, a plane unless it is stated. */
const shapeOf = (entry: JsonMap): string => textAt(entry, ["shape"]) ?? textAt(entry, ["surface"]) ?? "plane";

/** Sizes of other shapes than an entry's own. */
function foreign(entry: JsonMap, sizes: Sizes): Set<string> {
  const own = sizes[shapeOf(entry)];
  return new Set(
    own === undefined ? [] : Object.values(sizes).flatMap((all) => all.filter((one) => !own.includes(one))),
  );
}

/** The properties of an entry that its shape has. */
export function asked(properties: readonly string[], entry: JsonMap, sizes: Sizes): string[] {
  const others = foreign(entry, sizes);
  return properties.filter((name) => !others.has(name));
}

/** An entry without the sizes that its shape lacks. */
export function fitted(entry: Json | undefined, sizes: Sizes): JsonMap {
  if (!isMap(entry)) return {};
  const others = foreign(entry, sizes);
  return Object.fromEntries(Object.entries(entry).filter(([name]) => !others.has(name)));
}
