/** The 3-D view: which model it shows, and how it is moved. */

import { get, post, Refused } from "../api/client";
import type { Pose, Posed, View } from "../api/types";
import { elementIds } from "../model/elements";
import { merged, requestsOf } from "../model/pose";
import { reveal } from "./folding";
import { explain } from "./requests";
import { now, update } from "./store";

/** The view that is open, if it shows anything. */
export function shownView(): View | null {
  const { view } = now();
  return view !== null && "address" in view ? view : null;
}

/** The block of the open diagram, the mechanism of which is shown; "" of a mechanism's document. */
export function shownBlock(): string {
  const { block, document } = now();
  const moving = document?.diagram?.moving ?? [];
  return moving.includes(block) ? block : (moving[0] ?? "");
}

let asked = 0;

/** Brings the view up to the document as it is. */
export async function look(): Promise<void> {
  asked += 1;
  const turn = asked;
  const path = now().document?.path;
  const isPast = (): boolean => turn !== asked || now().document?.path !== path;
  try {
    const view = await get<View>(`api/view?block=${encodeURIComponent(shownBlock())}`);
    if (!isPast()) update({ view, stuck: "" });
  } catch (reason) {
    if (isPast()) return;
    if (reason instanceof Refused && reason.status === 422) update({ view: reason.fault });
    else explain(reason);
  }
}

export function lookAway(): void {
  asked += 1;
  update({ view: null, stuck: "" });
}

/** Chooses what somebody clicked in the picture. */
export function pick(element: string): void {
  const { document } = now();
  if (shownView() !== null && document?.diagram === null && elementIds(document).has(element)) reveal(element);
}

/** Takes over where the view stands after somebody dragged a frame in it. */
export function takePose({ why, ...stand }: Posed): void {
  const view = shownView();
  if (view !== null) update({ view: { ...view, ...stand }, stuck: why });
}

export function zoom(height: number | null): void {
  const view = shownView();
  if (view !== null) update({ view: { ...view, height } });
}

let next: Pose | null = null;
// Path of the document that it is of.
let of: string | undefined;
let moving = false;

/** Shows a run's state at a time. */
export function seek(run: string, t: number, block: string): void {
  void move({ run, t, block });
}

/** Moves the view; while one request is on its way, the newest of each value waits. */
export async function move(pose: Pose): Promise<void> {
  if (of !== now().document?.path) next = null;
  next = merged(next, pose);
  of = now().document?.path;
  if (moving) return;
  moving = true;
  try {
    while (next !== null) {
      const sent: Pose = next;
      next = null;
      const path = now().document?.path;
      if (of !== path) break; // A pose of a document that was left since.
      for (const request of requestsOf(sent)) {
        const { why, ...stand } = await post<Posed>("api/pose", request);
        const view = shownView();
        if (view !== null && now().document?.path === path) update({ view: { ...view, ...stand }, stuck: why });
      }
    }
  } catch (reason) {
    next = null;
    // A pose of what is no longer there is of no use; the view follows the document anyway.
    if (!(reason instanceof Refused && reason.status === 422)) explain(reason);
  } finally {
    moving = false;
  }
}
