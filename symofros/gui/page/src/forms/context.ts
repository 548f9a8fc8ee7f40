/** What every field of a window may need to know. */

import { createContext, useContext } from "react";

import type { Json, JsonMap, Path } from "../api/types";

export interface FormContext {
  /** The whole JSON Schema. */
  root: JsonMap;
  /** The document as it was when the window was opened. */
  data: JsonMap;
  /** The body whose window it is, if it is one's. */
  body: string | null;
  hint(text: string): void;
}

export const Form = createContext<FormContext>({ root: {}, data: {}, body: null, hint: () => undefined });
export const useForm = (): FormContext => useContext(Form);

export interface FieldProps<T = Json | undefined> {
  value: T;
  onChange(value: Json | undefined): void;
  path: Path;
  label: string;
}
