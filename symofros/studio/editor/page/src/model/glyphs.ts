/** Small line drawings, as path data in a square of 16: for blocks, the palette and the picture. */

import { JOINT_KINDS } from "./joints";

export const GLYPHS: Record<string, string> = {
  ...Object.fromEntries(Object.entries(JOINT_KINDS).map(([kind, { glyph }]) => [kind, glyph])),
  rigid_body: "M3 4.5h10v7H3z",
  massless_body: "M3 4.5h2M7 4.5h2M11 4.5h2v2M13 9.5v2h-2M9 11.5H7M5 11.5H3v-2M3 7.5v-3",
  beam: "M2 3v10M2 8c4 0 8-.5 12-4M2 10.5c4 0 9-.5 12.5-4",
  base: "M2 6h12M4 6l-2 3M8 6l-2 3M12 6l-2 3M8 2v4",
  gravity: "M8 2v11M4.5 9.5 8 13l3.5-3.5",
  closure: "M6.5 5H5a3 3 0 0 0 0 6h1.5M9.5 5H11a3 3 0 0 1 0 6H9.5M6 8h4",
  rod: "M4 12 12 4M2.5 12a1.5 1.5 0 1 0 3 0 1.5 1.5 0 1 0-3 0M10.5 4a1.5 1.5 0 1 0 3 0 1.5 1.5 0 1 0-3 0",
  spring: "M1 8h2l1-3 2 6 2-6 2 6 2-6 1 3h2",
  connection: "M1 8h2l1-3 2 6 2-6 2 6 2-6 1 3h2",
  nonholonomic: "M8 2.5a5 5 0 1 0 0 10 5 5 0 1 0 0-10M8 7.5l3-2.5M1.5 14.5h13",
  parameter: "M3 5h10M3 11h10M6 3v4M10.5 9v4",
  input: "M2 8h8M7 5l3 3-3 3M13 3v10",
  part: "M3 3h4v4H3zM9 9h4v4H9zM7 5h4v4",
  undo: "M5.5 3 2.5 6l3 3M2.5 6H10a3.5 3.5 0 0 1 0 7H6",
  redo: "M10.5 3l3 3-3 3M13.5 6H6a3.5 3.5 0 0 0 0 7h4",
  search: "M7 2.5a4.5 4.5 0 1 0 0 9 4.5 4.5 0 1 0 0-9M10.5 10.5 14 14",
  layout: "M2 6.5h4v3H2zM10 2.5h4v3h-4zM10 10.5h4v3h-4zM6 8h2M10 4H8v8h2",
  fit: "M2.5 6V2.5H6M10 2.5h3.5V6M13.5 10v3.5H10M6 13.5H2.5V10",
  theme: "M8 2.5a5.5 5.5 0 1 0 0 11zM8 2.5a5.5 5.5 0 0 1 0 11",
  close: "M4 4l8 8M12 4l-8 8",
  remove: "M3.5 8h9",
  plus: "M8 3.5v9M3.5 8h9",
  up: "M4 9.5 8 5.5l4 4",
  warning: "M8 2 1.5 13.5h13zM8 6.5v3.5M8 11.800h.01",
  motor: "M8 3.5a4.5 4.5 0 1 0 0 9 4.5 4.5 0 1 0 0-9M6 10V6l2 2.5L10 6v4",
};
