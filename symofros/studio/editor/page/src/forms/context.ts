/** What every field of a window may need to know. */

import { createContext, useContext } from "react";

import type { Json, JsonMap, Path } from "../api/types";
import type { Renames } from "../model/changes";
import type { Draft } from "./checks";

export interface FormContext {
  /** The whole JSON Schema. */
  root: JsonMap;
  /** The document as it was when the window was opened. */
  data: JsonMap;
  /** The body whose window it is, if it is one's. */
  body: string | null;
  /** New names of entries, made when the window is accepted. */
  renames: Renames;
  rename(path: Path, to: string): void;
  /** Told of each number as it is typed, so that it can be written so. */
  type(path: Path, text: string): void;
  hint(text: string): void;
  /** The entry with a field, as it stands in the window: the document may not have the field yet. */
  draft(path: Path): Draft | null;
  /** What a property of a record can be chosen from; null where it is typed. */
  choices(name: string, record: Json | undefined): readonly string[] | null;
}

export const Form = createContext<FormContext>({
  root: {},
  data: {},
  body: null,
  renames: {},
  rename: () => undefined,
  type: () => undefined,
  hint: () => undefined,
  draft: () => null,
  choices: () => null,
});
export const useForm = (): FormContext => useContext(Form);

/** What a control of one property gets. */
export interface ControlProps {
  value: Json | undefined;
  onChange(value: Json | undefined): void;
  path: Path;
  label: string;
  help: string;
}
