/** From the first request on: what the page asks at its start, and what it hears from then on. */

import { get } from "../api/client";
import { listen } from "../api/events";
import type { Catalogue } from "../api/types";
import { fetchParts } from "./clipboard";
import { refresh } from "./files";
import { hear } from "./jobs";
import { busy, explain } from "./requests";
import { now, update } from "./store";

export async function begin(): Promise<() => void> {
  const catalogue = await get<Catalogue>("api/schema").catch(explain);
  if (catalogue !== undefined) update({ catalogue });
  await refresh();
  if (now().document === null) return () => undefined;
  await fetchParts();
  return listen({
    document: (revision) => {
      // Our own changes come back here too, and bring nothing new.
      if (!busy() && revision !== now().document?.revision) void refresh();
    },
    job: hear,
    opened: () => {
      if (now().link !== "ok") void refresh();
    },
    lost: () => {
      if (now().link === "ok") void get("api/document").catch(explain);
    },
  });
}
