/** What the page knows. Everything else is drawn from it. */

import { create } from "zustand";

import type { Job, JobKind, RunPlot } from "../api/jobs";
import type {
  Catalogue,
  Document,
  Example,
  Fault,
  FileEntry,
  Json,
  LibraryPart,
  NativeFile,
  Path,
  Point,
  Pose,
  View,
} from "../api/types";
import type { AskedAnalysis, AskedRun, AskedSimulation } from "../model/asked";
import { type Moves, NO_MOVES } from "../model/moves";
import { isMap } from "../model/paths";
import type { KeptRun } from "../model/runs";
import type { Tour } from "../model/tour";

export type Link = "ok" | "lost" | "expired";
export type RightPane = "parameters" | "tree" | "text" | "view";
export type BottomPane = "problems" | JobKind;

export interface Anchor {
  body: string;
  frame: string;
}

export type Dialog =
  | { kind: "properties"; path: Path; entry?: Path }
  | { kind: "open"; files: FileEntry[] }
  | { kind: "examples"; examples: Example[] }
  | { kind: "new" }
  | { kind: "save as" }
  | { kind: "simulate"; asked: AskedSimulation }
  | { kind: "analyse"; asked: AskedAnalysis; state: AskedSimulation }
  | { kind: "run" }
  | { kind: "consent"; files: NativeFile[]; fault: Fault; proceed: () => void }
  | { kind: "export" }
  | { kind: "save part"; bodies: string[] }
  | { kind: "link"; first: Anchor; second: Anchor }
  | { kind: "discard"; proceed: () => void }
  | { kind: "changed on disk"; disk: string; over: string; path: string | null }
  | { kind: "search" }
  | { kind: "keys" };

/** The curves of a run that goes on, as far as they were told. */
export interface Live {
  id: string;
  plots: RunPlot[];
  t: number[];
  values: Record<string, (number | null)[]>;
}

export interface Notice {
  id: number;
  fault: Fault;
}

/** What is known of the open document, and means nothing in another one. */
export interface OfDocument {
  places: Record<string, Point>;
  selected: string[];
  /** Moves of blocks that can be undone and done again. */
  moves: Moves;
  /** Bodies that stand for all that they carry. */
  folded: readonly string[];
  /** What the names of the shown parameters have in them. */
  filter: string;
  /** A block that the canvas shall move into sight; a new object each time. */
  sight: { id: string } | null;
  jobs: Partial<Record<JobKind, Job>>;
  live: Live | null;
  /** Runs of this document, the newest last. */
  runs: readonly KeptRun[];
  /** Where the cursor of the plots and the motion in the 3-D view stand [s]; null before anybody has put it. */
  time: number | null;
  playing: boolean;
  /** The motion of an analysis that is played, such as a mode; "" for its first. */
  shape: string;
  /** The text as it was typed while the server did not answer, once its pane is closed; and what it was made from. */
  leftText: { text: string; base: string } | null;
  /** The block of a diagram, the mechanism of which the 3-D view shows; "" for the first. */
  block: string;
  /** What the 3-D view shows, while its pane is open; a fault: why it shows nothing. */
  view: View | Fault | null;
  /** What it was asked for and has not answered yet. */
  posing: Pose;
  /** Why it did not go where it was moved to. */
  stuck: string;
  /** What the import of this document left out or changed. */
  imported: readonly string[];
}

/** What a window asked last, of each document by its path: it is likely to be asked again. */
export interface Asked {
  simulate: Record<string, AskedSimulation>;
  run: Record<string, AskedRun>;
  analyse: Record<string, AskedAnalysis>;
}

export interface State extends OfDocument {
  catalogue: Catalogue | null;
  parts: LibraryPart[];
  document: Document | null;
  asked: Asked;
  dialog: Dialog | null;
  /** Seconds of the motion a second. */
  speed: number;
  link: Link;
  notices: Notice[];
  /** The step of the tour; null while nobody takes it. */
  tour: Tour | null;
  /** The menu of what was pressed with the other button: at a place of the window, which is a place of the canvas. */
  menu: { id: string | null; at: Point; where: Point } | null;
  right: RightPane | null;
  bottom: BottomPane | null;
}

/** What is known of a document that was just opened. */
export const OF_NEW_DOCUMENT: OfDocument = {
  places: {},
  selected: [],
  moves: NO_MOVES,
  folded: [],
  filter: "",
  sight: null,
  jobs: {},
  live: null,
  runs: [],
  time: null,
  playing: false,
  shape: "",
  leftText: null,
  block: "",
  view: null,
  posing: {},
  stuck: "",
  imported: [],
};

export const useStore = create<State>(() => ({
  ...OF_NEW_DOCUMENT,
  catalogue: null,
  parts: [],
  document: null,
  asked: { simulate: {}, run: {}, analyse: {} },
  dialog: null,
  speed: 1,
  link: "ok",
  notices: [],
  tour: null,
  menu: null,
  // On a phone it would lie over the diagram.
  right: globalThis.matchMedia?.("(max-width: 640px)").matches ? null : "parameters",
  bottom: null,
}));

export const update = useStore.setState;
export const now = useStore.getState;

/** The open document; only for what is drawn once there is one. */
export function useDocument(): Document {
  const document = useStore((state) => state.document);
  if (document === null) throw new Error("no document is open");
  return document;
}

// What a new document says.
const OF_EMPTY = ["bodies", "system", "symofros", "symofros_diagram", "name"];

/** Whether there is anything yet that could be wrong, or lost: a new file is no fault. */
export const useBegun = (): boolean => isBegun(useDocument());

export function isBegun({ data, text }: Document): boolean {
  if (Object.keys(data).length === 0) return text.trim() !== ""; // There is a text, and nothing can be made of it.
  return Object.keys(data).some((key) => !OF_EMPTY.includes(key) && filled(data[key])) || filled(data["bodies"]);
}

const filled = (section: Json | undefined): boolean =>
  isMap(section) ? Object.keys(section).length > 0 : section !== undefined && section !== null;

export const show = (dialog: Dialog): void => update({ dialog });
export const dismiss = (): void => update({ dialog: null });

/** Opens a window, unless another one was opened while the server was asked: what is typed there stays. */
export const showUnlessBusy = (dialog: Dialog): void => update((state) => (state.dialog === null ? { dialog } : {}));

/**
 * Closes the window that is open now, once what it asked for is done.
 *
 * @returns Whether it was still open: another one that was opened since stays.
 */
export function closing(): () => boolean {
  const { dialog } = now();
  return () => {
    const isOpen = now().dialog === dialog;
    if (isOpen) dismiss();
    return isOpen;
  };
}

let notices = 0;

export function notify(fault: Fault): void {
  notices += 1;
  const notice = { id: notices, fault };
  update((state) => ({ notices: [...state.notices.slice(-3), notice] }));
}

export function hush(id: number): void {
  update((state) => ({ notices: state.notices.filter((notice) => notice.id !== id) }));
}
