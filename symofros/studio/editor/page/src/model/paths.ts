/** Values inside the document, by path. */

import type { Edit, Json, JsonMap, Path } from "../api/types";

export function isMap(value: Json | undefined): value is JsonMap {
  return typeof value === "object" && value !== null && !Array.isArray(value);
}

export function at(root: Json | undefined, path: Path): Json | undefined {
  let value = root;
  for (const key of path) {
    if (Array.isArray(value) && typeof key === "number") value = value[key];
    else if (isMap(value)) value = value[String(key)];
    else return undefined;
  }
  return value;
}

/** The mapping at a path; empty where there is none. */
export function mapAt(root: Json | undefined, path: Path): JsonMap {
  const value = at(root, path);
  return isMap(value) ? value : {};
}

export function textAt(root: Json | undefined, path: Path): string | undefined {
  const value = at(root, path);
  return typeof value === "string" ? value : undefined;
}

export function same(a: Json | undefined, b: Json | undefined): boolean {
  if (a === b) return true;
  if (Array.isArray(a) && Array.isArray(b)) return a.length === b.length && a.every((item, i) => same(item, b[i]));
  if (isMap(a) && isMap(b)) {
    const keys = Object.keys(a);
    return keys.length === Object.keys(b).length && keys.every((key) => key in b && same(a[key], b[key]));
  }
  return false;
}

/** The fewest edits that turn `before` into `after`, so that all other text of the file stays as it is. */
export function difference(before: Json | undefined, after: Json | undefined, path: Path): Edit[] {
  if (same(before, after)) return [];
  if (after === undefined) return [{ op: "remove", path }];
  if (isMap(before) && isMap(after)) {
    const keys = [...new Set([...Object.keys(before), ...Object.keys(after)])];
    return keys.flatMap((key) => difference(before[key], after[key], [...path, key]));
  }
  if (Array.isArray(before) && Array.isArray(after) && before.length === after.length) {
    return after.flatMap((item, i) => difference(before[i], item, [...path, i]));
  }
  return [{ op: "set", path, value: after }];
}

/** `value` with one key of a mapping or place of a list replaced; undefined takes it away. */
export function replaced(value: Json | undefined, key: string | number, by: Json | undefined): Json {
  if (typeof key === "number") {
    const list = Array.isArray(value) ? [...value] : [];
    if (by === undefined) list.splice(key, 1);
    else list[key] = by;
    return list;
  }
  const map = isMap(value) ? { ...value } : {};
  if (by === undefined) delete map[key];
  else map[key] = by;
  return map;
}
