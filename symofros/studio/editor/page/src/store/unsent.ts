/** What is typed and not yet sent: sent before the document is saved, left or run. */

import { answered } from "./requests";

type Send = () => Promise<unknown>;

const sends = new Set<Send>();

/** Has `send` called whenever what is typed must be in the document; the answer ends that. */
export function sentBefore(send: Send): () => void {
  sends.add(send);
  return () => void sends.delete(send);
}

/** Waits until all that is typed or on its way is in the document, as far as the server takes it. */
export async function settle(): Promise<void> {
  await Promise.all([...sends].map((send) => send()));
  await answered();
}
