/** Files: open, new, save, import; never over something that nobody has seen. */

import { get, post, type Refused } from "../api/client";
import type { Document, Example, FileEntry } from "../api/types";
import { change, setText } from "./edits";
import { followPath } from "./asked";
import { accept, acceptTheirs, explain, ordered } from "./requests";
import { settle } from "./unsent";
import { closing, isBegun, now, show, showUnlessBusy, update } from "./store";

/** Takes what the server answers as the open document; asks first if unsaved work would be lost. */
async function replace(address: string, body: object): Promise<void> {
  const closeAsking = closing();
  await settle();
  const change = async (discard: boolean, close = closing()): Promise<void> => {
    const answer = await ordered(() => post<Document & { notes?: string[] }>(address, { ...body, discard }));
    if (answer === undefined) return;
    const { notes = [], ...document } = answer;
    accept(document);
    close();
    update({ imported: notes });
  };
  const { document } = now();
  if (document?.dirty === true && isBegun(document)) show({ kind: "discard", proceed: () => void change(true) });
  else await change(false, closeAsking);
}

export const open = (path: string): Promise<void> => replace("api/open", { path });
export const begin = (path: string, kind: "mechanism" | "diagram"): Promise<void> => replace("api/new", { path, kind });

/** Goes into a model or a part of the diagram: its file becomes the open one, until one leaves it again. */
export async function enter(path: string): Promise<boolean> {
  await settle();
  return change("api/enter", () => ({ path }));
}

/** Back to the diagram that one came from. */
export async function leave(): Promise<void> {
  await settle();
  const back = async (discard: boolean): Promise<void> => {
    const close = closing();
    if (await change("api/leave", () => ({ discard }))) close();
  };
  if (now().document?.dirty === true) show({ kind: "discard", proceed: () => void back(true) });
  else await back(false);
}

export const importText = (name: string, text: string): Promise<void> => replace("api/import", { name, text });

export const importPath = (path: string): Promise<void> => replace("api/import", { path });

export async function importFile(file: File): Promise<void> {
  await importText(file.name, await file.text());
}

export async function browse(): Promise<void> {
  const answer = await ordered(() => get<{ files: FileEntry[] }>("api/files"));
  if (answer !== undefined) showUnlessBusy({ kind: "open", files: answer.files });
}

export async function browseExamples(): Promise<void> {
  const answer = await ordered(() => get<{ examples: Example[] }>("api/examples"));
  if (answer !== undefined) showUnlessBusy({ kind: "examples", examples: answer.examples });
}

/** A new document that says what an example says. */
export const takeExample = (name: string): Promise<void> => replace("api/example", { name });

/** Saves; `over` names the state of the file that the user has seen and gives up. */
export async function save(path: string | null = null, over: string | null = null): Promise<boolean> {
  await settle();
  const before = now().document?.path;
  const ask = (): Promise<Document> => post("api/save", { revision: now().document?.revision ?? 0, path, over });
  const conflict = async (refusal: Refused): Promise<undefined> => {
    const { disk, over: state } = refusal.body;
    if (refusal.status === 409 && disk !== undefined && state !== undefined)
      show({ kind: "changed on disk", disk, over: state, path });
    else explain(refusal);
    return undefined;
  };
  const document = await ordered(ask, conflict);
  if (document === undefined) return false;
  const isMoved = before !== undefined && before !== document.path && before === now().document?.path;
  if (isMoved) followPath(before, document.path);
  accept(document, isMoved);
  return true;
}

/** Back to the file as it was saved; undo brings back what was given up. */
export const discard = (): Promise<boolean> => change("api/discard", () => ({}));

/** Takes the file as somebody else wrote it; undo brings back what was here. */
export const reload = (): Promise<boolean> => change("api/reload", () => ({}));

/** The newest document, after somebody else changed it or the server came back; what waits for it is sent. */
export async function refresh(): Promise<void> {
  const document = await ordered(() => get<Document>("api/document"));
  if (document === undefined) return;
  acceptTheirs(document);
  // After that: what waits for the server is of the document that is there now, or of none.
  const { leftText } = now();
  update({ link: "ok", leftText: null });
  if (leftText !== null) await setText(leftText.text, leftText.base, document.path);
}
