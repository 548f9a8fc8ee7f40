/** The server's stream of events; the browser connects again by itself when it breaks. */

import { withToken } from "./client";
import type { Job } from "./jobs";

export interface Listener {
  document(revision: number): void;
  job(job: Job): void;
  opened(): void;
  lost(): void;
}

export function listen(listener: Listener): () => void {
  const source = new EventSource(withToken("api/events"));
  source.addEventListener("open", () => listener.opened());
  source.addEventListener("error", () => listener.lost());
  source.addEventListener("document", (event) => {
    listener.document((JSON.parse(event.data as string) as { revision: number }).revision);
  });
  source.addEventListener("job", (event) => listener.job(JSON.parse(event.data as string) as Job));
  return () => source.close();
}
