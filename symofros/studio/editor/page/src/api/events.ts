/** The server's stream of events. */

import { withToken } from "./client";
import type { Job, Samples } from "./jobs";
import type { Posed } from "./types";

export interface Listener {
  document(revision: number, name: string): void;
  disk(): void;
  job(job: Job): void;
  samples(samples: Samples): void;
  /** Somebody clicked an element in the 3-D view. */
  picked(element: string): void;
  /** How high the picture of the 3-D view is at the depth of what its camera looks at [m]. */
  zoomed(height: number | null): void;
  /** Where the 3-D view stands after somebody dragged a frame. */
  posed(posed: Posed): void;
  lost(): void;
}

export function listen(listener: Listener): void {
  const source = new EventSource(withToken("api/events"));
  // The browser would try again by itself, but cannot tell a server that is gone from one that refuses.
  source.addEventListener("error", () => {
    source.close();
    listener.lost();
  });
  source.addEventListener("document", (event) => {
    const { revision, name } = JSON.parse(event.data as string) as { revision: number; name: string };
    listener.document(revision, name);
  });
  source.addEventListener("picked", (event) => {
    listener.picked((JSON.parse(event.data as string) as { element: string }).element);
  });
  source.addEventListener("zoom", (event) => {
    listener.zoomed((JSON.parse(event.data as string) as { height: number | null }).height);
  });
  source.addEventListener("posed", (event) => listener.posed(JSON.parse(event.data as string) as Posed));
  source.addEventListener("disk", () => listener.disk());
  source.addEventListener("samples", (event) => listener.samples(JSON.parse(event.data as string) as Samples));
  source.addEventListener("job", (event) => listener.job(JSON.parse(event.data as string) as Job));
}
