/** Taking elements away, of mechanisms and of diagrams. */

import { remove as removeBodies } from "./bodies";
import { remove as removeBlocks } from "./diagram";
import { now } from "./store";

export const remove = (ids: string[]): Promise<void> =>
  now().document?.diagram === null ? removeBodies(ids) : removeBlocks(ids);
