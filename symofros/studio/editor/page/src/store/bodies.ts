/** What a person does to the diagram: add, link, unlink, remove. */

import type { Edit, Json, JsonMap, PaletteItem, Point } from "../api/types";
import { frameNames, fresh, symbols } from "../model/names";
import { at, isMap, mapAt, textAt } from "../model/paths";
import { beside } from "../model/sections";
import { usesOf } from "../model/uses";
import { addEntry, edit, place } from "./edits";
import { reveal } from "./folding";
import { type Anchor, now, show, showUnlessBusy, update } from "./store";

const data = (): JsonMap => now().document?.data ?? {};

export function selectedBodies(): string[] {
  return now()
    .selected.filter((id) => /^bodies\/[^/]+$/.test(id))
    .map((id) => id.slice("bodies/".length));
}

/** The last frame of each selected body. */
function selectedFrames(): Anchor[] {
  return selectedBodies().map((body) => ({ body, frame: frameNames(data(), body).at(-1) ?? "" }));
}

/** The frame that a new body goes to: that of the only selected body, else the ground. */
export function carrier(): Anchor | null {
  const [chosen, ...others] = selectedFrames();
  return chosen !== undefined && others.length === 0 ? chosen : null;
}

const anchor = ({ body, frame }: Anchor): JsonMap => (frame === "" ? { body } : { body, frame });

/** A template's ends on the selected bodies: of a link on one or two, of a condition on one. */
function aimed(template: Json): Json {
  if (!isMap(template)) return template;
  const [first, second, ...more] = selectedFrames();
  if (first === undefined || more.length > 0) return template;
  if ("first" in template)
    return { ...template, first: anchor(first), ...(second === undefined ? {} : { second: anchor(second) }) };
  if (second !== undefined) return template;
  return Object.fromEntries(
    Object.entries(template).map(([key, value]) => [
      key,
      isMap(value) && "body" in value ? { ...value, body: first.body } : value,
    ]),
  );
}

function attached(template: Json, on: Anchor | null, name: string, data: JsonMap): Json {
  if (!isMap(template) || !isMap(template["joint"])) return template;
  const taken = symbols(data);
  const coordinate: JsonMap = template["joint"]["kind"] === "fixed" ? {} : { name: fresh("q1", taken) };
  const joint: JsonMap = { ...coordinate, ...template["joint"] };
  if (on !== null && on.body !== name) joint["parent"] = on.body;
  if (on !== null && on.frame !== "") joint["frame"] = on.frame;
  return { ...template, joint };
}

/** Adds what a palette entry says; at a place if it was dropped there, beside the selected block if not. */
export async function add(item: PaletteItem, where?: Point): Promise<void> {
  if (item.section === "system") {
    show({ kind: "properties", path: ["system"] });
    return;
  }
  const isSymbol = item.section === "parameters" || item.section === "inputs";
  const taken = (data: JsonMap): string[] => (isSymbol ? symbols(data) : Object.keys(mapAt(data, [item.section])));
  const idOf = (name: string): string => (item.kind === "base" ? "world" : `${item.section}/${name}`);
  // On what is chosen now, whatever is when its turn comes.
  const [on, aim] = [carrier(), aimed(item.template)];
  const name = await addEntry(item.section, item.name, taken, (name, data) => {
    if (where !== undefined) update((state) => ({ places: { ...state.places, [idOf(name)]: where } }));
    return item.section === "bodies" ? attached(item.template, on, name, data) : aim;
  });
  if (name === undefined) return;
  const id = idOf(name);
  if (where !== undefined) await place({ [id]: where });
  if (item.section === "bodies" || item.section === "nonholonomic") reveal(id);
  if (isSymbol) update({ right: "parameters" });
  else if (item.section !== "bodies") showUnlessBusy({ kind: "properties", path: [item.section, name] });
}

/** Puts a body's joint into a frame of another body. */
export function mount(body: string, on: Anchor): Promise<boolean> {
  const joint = ["bodies", body, "joint"];
  const frame: Edit[] =
    on.frame !== ""
      ? [{ op: "set", path: [...joint, "frame"], value: on.frame }]
      : textAt(data(), [...joint, "frame"]) !== undefined
        ? [{ op: "remove", path: [...joint, "frame"] }]
        : [];
  return edit(`mount ${body}`, [{ op: "set", path: [...joint, "parent"], value: on.body }, ...frame]);
}

/** Links two frames as a palette entry says: they stay together, a spring is between them, one touches the other. */
export async function join(item: PaletteItem, first: Anchor, second: Anchor): Promise<void> {
  const value = { ...mapAt(item.template, []), first: anchor(first), second: anchor(second) };
  const taken = (data: JsonMap): string[] => Object.keys(mapAt(data, [item.section]));
  const name = await addEntry(item.section, item.name, taken, () => value);
  if (name !== undefined) showUnlessBusy({ kind: "properties", path: [item.section, name] });
}

/** Edits that take an element of the diagram away, with what cannot be without it. */
function removal(id: string): Edit[] {
  const graph = now().document?.graph;
  const edge = graph?.edges.find((each) => each.id === id);
  if (edge?.kind === "joint") {
    const joint = mapAt(data(), edge.path);
    return ["parent", "frame"]
      .filter((key) => key in joint)
      .map((key) => ({ op: "remove", path: [...edge.path, key] }));
  }
  const path = edge?.path ?? graph?.nodes.find((node) => node.id === id)?.path ?? [];
  const [section, name] = path;
  if (name === undefined) return [];
  const uses = section === "bodies" ? usesOf(data(), String(name)) : [];
  // A switch goes with its constraint.
  return [...uses, path].flatMap((each): Edit[] => {
    const other = each[0] === "bodies" ? null : beside(each);
    const gone = other !== null && at(data(), other) !== undefined ? [other, each] : [each];
    return gone.map((one) => ({ op: "remove", path: one }));
  });
}

export async function remove(ids: string[]): Promise<void> {
  const gone = new Set(ids);
  // A joint goes with its body.
  const kept = ids.filter((id) => !(id.endsWith("/joint") && gone.has(id.slice(0, -"/joint".length))));
  const seen = new Set<string>();
  const edits = kept.flatMap(removal).filter(({ path }) => {
    const key = path.join("/");
    return !seen.has(key) && seen.add(key);
  });
  const label = kept.length === 1 ? `remove ${kept[0]?.split("/")[1] ?? ""}` : `remove ${kept.length} elements`;
  await edit(label, edits);
}
