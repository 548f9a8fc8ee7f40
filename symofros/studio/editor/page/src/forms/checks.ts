/** Questions about formulas, those of one moment in one request: a window asks about each of its fields as it opens. */

import { post } from "../api/client";
import type { Checked, Json, Path } from "../api/types";

/** The entry that a window is about, as it stands in the window. */
export interface Draft {
  path: Path;
  value: Json;
}

interface Question {
  path: Path;
  text: string;
  draft: Draft | null;
  answer(checked: Checked): void;
  fail(reason: unknown): void;
}

/** Fields pause before they ask; those that were drawn together ask within this time [ms]. */
const MOMENT = 20;

let waiting: Question[] = [];

async function ask(): Promise<void> {
  const questions = waiting;
  waiting = [];
  try {
    const fields = questions.map(({ path, text, draft }) => ({ path, text, draft }));
    const { checks } = await post<{ checks: Checked[] }>("api/expression", { fields });
    questions.forEach(({ answer }, i) => answer(checks[i] as Checked));
  } catch (reason) {
    for (const { fail } of questions) fail(reason);
  }
}

/** What the server says of a formula at a place; of one that the document may not have yet, as `draft` has it. */
export function check(path: Path, text: string, draft: Draft | null = null): Promise<Checked> {
  return new Promise((answer, fail) => {
    if (waiting.length === 0) window.setTimeout(() => void ask(), MOMENT);
    waiting.push({ path, text, draft, answer, fail });
  });
}
