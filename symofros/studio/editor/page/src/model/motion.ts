/** What a run can be given by name: coordinates with their speeds, and inputs. */

import type { JsonMap } from "../api/types";
import { speeds } from "./joints";
import { bodyNames, jointName } from "./names";
import { mapAt } from "./paths";

/** Bodies whose joint has one coordinate, which bears the joint's name. */
function simple(data: JsonMap): string[] {
  return bodyNames(data).filter((body) => {
    const joint = mapAt(data, ["bodies", body, "joint"]);
    return joint["kind"] !== "general" && speeds(joint) === 1;
  });
}

/** Coordinates that a number each can start; the others start neutral and at rest. */
export function coordinates(data: JsonMap): string[] {
  const free = simple(data).filter((body) => mapAt(data, ["bodies", body, "joint"])["prescribed"] !== true);
  return free.map((body) => jointName(data, body));
}

/** Inputs with names of their own, and those of actuated joints. */
export function inputs(data: JsonMap): string[] {
  const driven = simple(data).filter((body) => mapAt(data, ["bodies", body, "joint"])["actuated"] === true);
  return [...Object.keys(mapAt(data, ["inputs"])), ...driven.map((body) => jointName(data, body))];
}
