/** The browser's own dialogs for files: one to take, one to give. */

import type { Document } from "../api/types";
import { importFile } from "../store/files";

export const IMPORTED = [".yaml", ".yml", ".urdf", ".xml", ".mjcf"];

export function chooseImport(): void {
  const input = window.document.createElement("input");
  input.type = "file";
  input.accept = IMPORTED.join(",");
  // While the dialog is open the page holds it: nothing else does, and what nobody holds may be gone before the answer.
  input.hidden = true;
  window.document.body.append(input);
  input.addEventListener("cancel", () => input.remove());
  input.addEventListener("change", () => {
    const file = input.files?.[0];
    input.remove();
    if (file !== undefined) void importFile(file);
  });
  input.click();
}

/** Hands the text of a document to the browser as a file. */
export const saveText = ({ text, name }: Document): void => offer(new Blob([text], { type: "text/yaml" }), name);

export function offer(blob: Blob, name: string): void {
  const link = window.document.createElement("a");
  link.href = URL.createObjectURL(blob);
  link.download = name;
  link.click();
  // The browser has taken it by then.
  window.setTimeout(() => URL.revokeObjectURL(link.href), 10_000);
}
