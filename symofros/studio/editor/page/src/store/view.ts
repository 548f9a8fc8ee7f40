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
// Answers to poses so far: a picture that was derived before one of them does not know it.
let stands = 0;

/** Brings the view up to the document as it is. */
export async function look(): Promise<void> {
  asked += 1;
  const [turn, before] = [asked, stands];
  const path = now().document?.path;
  const isPast = (): boolean => turn !== asked || now().document?.path !== path;
  try {
    const view = await get<View>(`api/view?block=${encodeURIComponent(shownBlock())}`);
    if (isPast()) return;
    update({ view, stuck: "" });
    if (stands !== before) await move({});
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

/** Takes over where the view stands after a request, or after somebody dragged a frame in it. */
export function takePose({ why, ...stand }: Posed): void {
  const view = shownView();
  if (view !== null) update({ view: { ...view, ...stand }, stuck: why });
}

export function zoom(height: number | null): void {
  const view = shownView();
  if (view !== null) update({ view: { ...view, height } });
}

/** A pose of a document at a path. */
interface Asked {
  pose: Pose;
  of: string | undefined;
}

let sent: Asked | null = null;
let next: Asked | null = null;

/** A pose if it is of the open document. */
const ours = (asked: Asked | null): Pose | null =>
  asked !== null && asked.of === now().document?.path ? asked.pose : null;

const notePosing = (): void => update({ posing: merged(ours(sent), ours(next) ?? {}) });

/** Shows a run's state at a time. */
export function seek(run: string, t: number, block: string): void {
  void move({ run, t, block });
}

/** Moves the view; while one request is on its way, the newest of each value waits. */
export async function move(pose: Pose): Promise<void> {
  next = { pose: merged(ours(next), pose), of: now().document?.path };
  notePosing();
  if (sent !== null) return;
  try {
    while (ours(next) !== null) {
      [sent, next] = [next as Asked, null];
      for (const request of requestsOf(sent.pose)) await ask(request, sent.of);
      sent = null;
      notePosing();
    }
  } finally {
    sent = null;
  }
}

async function ask(request: Pose, of: string | undefined): Promise<void> {
  try {
    const stand = await post<Posed>("api/pose", request);
    stands += 1;
    if (now().document?.path === of) takePose(stand);
  } catch (reason) {
    // A pose of what is no longer there is of no use; the view follows the document anyway.
    if (!(reason instanceof Refused && reason.status === 422)) explain(reason);
  }
}
