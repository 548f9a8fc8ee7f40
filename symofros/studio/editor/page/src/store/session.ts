/** From the first request on: what the page asks at its start, and what it hears from then on. */

import { get } from "../api/client";
import { listen } from "../api/events";
import type { Catalogue } from "../api/types";
import { fetchParts } from "./clipboard";
import { refresh } from "./files";
import { hear, hearSamples } from "./jobs";
import { answered, explain } from "./requests";
import { notify, now, update } from "./store";
import { pick, takePose, zoom } from "./view";

const PAUSE = 1000;

/** Listens to the server until it is gone; then asks until it is back, or another one is there. */
async function attend(): Promise<void> {
  for (;;) {
    await new Promise<void>((lost) => {
      listen({
        document: (revision, name) => void heed(revision, name),
        disk: () => void refresh(),
        job: hear,
        samples: hearSamples,
        picked: pick,
        zoomed: zoom,
        posed: takePose,
        lost,
      });
    });
    let isBack = false;
    while (!isBack) {
      isBack = await answers();
      // Also when it is there: a stream that breaks again and again must not be asked for without a pause.
      await new Promise((resume) => window.setTimeout(resume, PAUSE));
    }
    if (now().link === "expired") return;
    await refresh();
  }
}

/** Asks for the document where it has changed; our own changes come back here too, and bring nothing new. */
async function heed(revision: number, name: string): Promise<void> {
  // The answer to a change of ours may be on its way.
  await answered();
  const known = now().document;
  if (known === null || revision > known.revision || name !== known.name) await refresh();
}

/** Whether the server says anything, be it that we are strangers. */
async function answers(): Promise<boolean> {
  const answer = await get("api/document").catch(explain);
  return answer !== undefined || now().link === "expired";
}

/** Says what went wrong where nobody waits for the answer: it is a fault of the page. */
function sayUnforeseen(reason: unknown): void {
  notify({
    object: "the page met a fault of its own",
    found: reason instanceof Error ? `${reason.name}: ${reason.message}` : String(reason),
    rule: "this should not happen; the server keeps the document as it was",
    remedy: "reload the page; please report it, with what you did",
  });
}

export async function begin(): Promise<void> {
  window.addEventListener("unhandledrejection", ({ reason }) => sayUnforeseen(reason));
  const catalogue = await get<Catalogue>("api/schema").catch(explain);
  if (catalogue !== undefined) update({ catalogue });
  await refresh();
  if (now().document === null) return;
  await fetchParts();
  await attend();
}
