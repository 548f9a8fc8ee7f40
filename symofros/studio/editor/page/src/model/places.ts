/** Places of blocks that are clear of each other. */

import type { Point } from "../api/types";

export type Places = Record<string, Point>;

function overlaps(a: Point, aSize: Point, b: Point, bSize: Point): boolean {
  return [0, 1].every(
    (i) => (a[i] ?? 0) < (b[i] ?? 0) + (bSize[i] ?? 0) && (b[i] ?? 0) < (a[i] ?? 0) + (aSize[i] ?? 0),
  );
}

interface Placed {
  id: string;
}

/**
 * Places of all blocks.
 *
 * @param known Where blocks stand; they stay there.
 * @param remembered Where a block of that name stood once: it goes there again if there is room.
 * @param size Width and height of a block.
 * @param start Where a block that has neither would stand best, when the others have their places.
 * @returns Of a block that has neither, a place from there downwards that is clear of all others.
 */
export function completedPlaces<N extends Placed>(
  nodes: readonly N[],
  known: Places,
  remembered: Places,
  size: (node: N) => Point,
  start: (node: N, places: Places) => Point,
): Places {
  const byId = new Map(nodes.map((node) => [node.id, node]));
  const places: Places = {};
  for (const node of nodes) {
    const place = known[node.id];
    if (place !== undefined) places[node.id] = place;
  }
  for (const node of nodes.filter((each) => !(each.id in places))) {
    const isFree = (place: Point): boolean =>
      Object.entries(places).every(([id, other]) => !overlaps(place, size(node), other, size(byId.get(id) as N)));
    const old = remembered[node.id];
    let place = old !== undefined && isFree(old) ? old : start(node, places);
    while (!isFree(place)) place = [place[0], place[1] + 24];
    places[node.id] = place;
  }
  return places;
}
