/** Edits of parameters. */

import type { Edit, Json } from "../api/types";
import { at, isMap } from "./paths";

/** An entry may be a number alone; then what else is said of it makes it a mapping. */
export function parameterChange(data: Json, name: string, key: string, value: Json | undefined): Edit[] {
  const path = ["parameters", name];
  const entry = at(data, path);
  if (!isMap(entry))
    return [{ op: "set", path, value: key === "value" ? (value ?? 0) : { value: entry ?? 0, [key]: value ?? "" } }];
  if (value === undefined) return key in entry ? [{ op: "remove", path: [...path, key] }] : [];
  return [{ op: "set", path: [...path, key], value }];
}
