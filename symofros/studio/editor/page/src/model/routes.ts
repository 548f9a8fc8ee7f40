/** The ways of wires: along the grid, around blocks where there is room, and beside other signals, not on them. */

import type { Point } from "../api/types";

export interface Box {
  x: number;
  y: number;
  width: number;
  height: number;
}

export interface End {
  id: string;
  /** Wires of one signal may lie on each other. */
  signal: string;
  from: Point;
  to: Point;
}

interface Segment {
  signal: string;
  a: Point;
  b: Point;
}

const LEAD = 12;
const STEP = 6;
const CLEAR = 10;
// What it costs to go through a block, and along another signal; a pixel of the way costs one.
const THROUGH = 4000;
const ALONG = 260;
const CROSSED = 12;
const BEND = 14;
// From here on ways are not searched for: a drag must stay fluid.
const MOST = 150;

const sorted = (a: number, b: number): [number, number] => (a < b ? [a, b] : [b, a]);

function hits({ a, b }: Segment, box: Box): boolean {
  const [left, right] = sorted(a[0], b[0]);
  const [top, bottom] = sorted(a[1], b[1]);
  return right > box.x - 4 && left < box.x + box.width + 4 && bottom > box.y - 4 && top < box.y + box.height + 4;
}

/** Whether two segments lie on each other, or cross. */
function meet(one: Segment, other: Segment): "along" | "crossed" | null {
  const isLevel = (s: Segment): boolean => s.a[1] === s.b[1];
  const [axis, side] = isLevel(one) ? ([0, 1] as const) : ([1, 0] as const);
  const [low, high] = sorted(one.a[axis], one.b[axis]);
  if (isLevel(one) === isLevel(other)) {
    const [from, to] = sorted(other.a[axis], other.b[axis]);
    const isNear = Math.abs(one.a[side] - other.a[side]) < 4;
    return isNear && from < high - 2 && to > low + 2 ? "along" : null;
  }
  const [from, to] = sorted(other.a[side], other.b[side]);
  const across = one.a[side];
  const along = other.a[axis];
  return along > low && along < high && across > from && across < to ? "crossed" : null;
}

function segments(points: readonly Point[], signal: string): Segment[] {
  return points.slice(1).flatMap((b, i) => {
    const a = points[i] as Point;
    return a[0] === b[0] && a[1] === b[1] ? [] : [{ signal, a, b }];
  });
}

function cost(way: readonly Segment[], ends: readonly Box[], boxes: readonly Box[], drawn: readonly Segment[]): number {
  let total = BEND * way.length;
  way.forEach((segment, i) => {
    total += Math.abs(segment.a[0] - segment.b[0]) + Math.abs(segment.a[1] - segment.b[1]);
    // The first and the last touch the blocks that they join.
    const isInner = i > 0 && i < way.length - 1;
    for (const box of boxes) if ((isInner || !ends.includes(box)) && hits(segment, box)) total += THROUGH;
    for (const other of drawn) {
      if (other.signal === segment.signal) continue;
      const how = meet(segment, other);
      total += how === "along" ? ALONG : how === "crossed" ? CROSSED : 0;
    }
  });
  return total;
}

/** All ways that are tried: with one vertical in between, or with a level stretch above or below some block. */
function ways({ from, to }: End, boxes: readonly Box[]): Point[][] {
  const [x0, y0] = from;
  const [x1, y1] = to;
  const tried: Point[][] = [];
  if (x1 - x0 >= 2 * LEAD) {
    if (y0 === y1) tried.push([from, to]);
    const last = Math.floor((x1 - x0 - 2 * LEAD) / STEP);
    const steps = [...new Set([0, 1, 2, 3, 4, 5, last >> 1, last - 5, last - 4, last - 3, last - 2, last - 1, last])];
    for (const step of steps.filter((each) => each >= 0 && each <= last)) {
      const x = x0 + LEAD + STEP * step;
      tried.push([from, [x, y0], [x, y1], to]);
    }
  }
  const levels = boxes.flatMap(({ y, height }) =>
    [0, 1, 2, 3].flatMap((i) => [y - CLEAR - STEP * i, y + height + CLEAR + STEP * i]),
  );
  for (const level of new Set(levels.map(Math.round)))
    for (const [out, back] of [
      [0, 0],
      [1, 1],
      [2, 2],
      [3, 0],
      [0, 3],
    ] as const) {
      const a = x0 + LEAD + STEP * out;
      const b = x1 - LEAD - STEP * back;
      tried.push([from, [a, y0], [a, level], [b, level], [b, y1], to]);
    }
  return tried;
}

/** A way without regard to anything else. */
function plain({ from, to }: End): Point[] {
  const [x0, y0] = from;
  const [x1, y1] = to;
  if (x1 - x0 >= 2 * LEAD) {
    const x = (x0 + x1) / 2;
    return [from, [x, y0], [x, y1], to];
  }
  const level = Math.max(y0, y1) + 60;
  return [from, [x0 + LEAD, y0], [x0 + LEAD, level], [x1 - LEAD, level], [x1 - LEAD, y1], to];
}

/** Points along each wire. */
export function routes(wires: readonly End[], boxes: readonly Box[]): Map<string, Point[]> {
  if (boxes.length > MOST) return new Map(wires.map((wire) => [wire.id, plain(wire)]));
  const drawn: Segment[] = [];
  const found = new Map<string, Point[]>();
  const reach = ({ from, to }: End): number => Math.abs(from[0] - to[0]) + Math.abs(from[1] - to[1]);
  // Short wires first: they have the fewest ways to go.
  for (const wire of [...wires].sort((a, b) => reach(a) - reach(b))) {
    const touches = (box: Box): boolean =>
      (box.x + box.width === wire.from[0] && wire.from[1] >= box.y && wire.from[1] <= box.y + box.height) ||
      (box.x === wire.to[0] && wire.to[1] >= box.y && wire.to[1] <= box.y + box.height);
    const ends = boxes.filter(touches);
    let best = plain(wire);
    let least = Infinity;
    for (const points of ways(wire, boxes)) {
      const price = cost(segments(points, wire.signal), ends, boxes, drawn);
      if (price < least) [best, least] = [points, price];
    }
    drawn.push(...segments(best, wire.signal));
    found.set(wire.id, best);
  }
  return found;
}

const RADIUS = 4;

/** The points as a line with rounded corners. */
export function rounded(points: readonly Point[]): string {
  const [first, ...rest] = points;
  if (first === undefined) return "";
  let path = `M${first[0]},${first[1]}`;
  rest.forEach((corner, i) => {
    const before = points[i] as Point;
    const next = rest[i + 1];
    if (next === undefined) {
      path += `L${corner[0]},${corner[1]}`;
      return;
    }
    const room = (a: Point): number => Math.abs(a[0] - corner[0]) + Math.abs(a[1] - corner[1]);
    const r = Math.min(RADIUS, room(before) / 2, room(next) / 2);
    const toward = (a: Point): Point => [
      corner[0] + Math.sign(a[0] - corner[0]) * r,
      corner[1] + Math.sign(a[1] - corner[1]) * r,
    ];
    const [a, b] = [toward(before), toward(next)];
    path += `L${a[0]},${a[1]}Q${corner[0]},${corner[1]} ${b[0]},${b[1]}`;
  });
  return path;
}
