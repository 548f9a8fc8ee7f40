/** Blocks of a diagram become a subsystem: the server writes its file, and puts a part in their place. */

import { fresh } from "../model/names";
import { mapAt } from "../model/paths";
import { change, place } from "./edits";
import { settle } from "./unsent";
import { now, update } from "./store";

/** Groups the chosen blocks; where they stood, in the middle, stands the part. */
export async function group(ids: readonly string[]): Promise<void> {
  await settle();
  const { document, places } = now();
  const blocks = ids.filter((id) => /^(blocks|parts)\//.test(id));
  if (document === null || blocks.length === 0) return;
  const taken = ["blocks", "parts"].flatMap((section) => Object.keys(mapAt(document.data, [section])));
  const name = fresh("subsystem", taken);
  const at = blocks.flatMap((id) => places[id] ?? []);
  const middle = (k: 0 | 1): number => {
    const all = at.filter((_, i) => i % 2 === k);
    return Math.round(all.reduce((sum, each) => sum + each, 0) / Math.max(1, all.length));
  };
  if (!(await change("api/group", () => ({ name, blocks })))) return;
  const id = `parts/${name}`;
  if (at.length > 0) await place({ [id]: [middle(0), middle(1)] });
  update({ selected: [id], sight: { id } });
}
