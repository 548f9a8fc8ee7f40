/** The tour's beginning. */

import { now, update } from "./store";

export const beginTour = (): void => update({ tour: { step: 0, since: now().document?.step ?? 0 } });
