/** What a person does to a diagram of signals: add, link, unlink, remove, look at a signal. */

import { get } from "../api/client";
import type { BlockItem, Diagram, Edit, FileEntry, Json, JsonMap, Path, Point, SignalNode } from "../api/types";
import { isMap, mapAt, textAt } from "../model/paths";
import { addEntry, edit, place } from "./edits";
import { ordered } from "./requests";
import { now, update } from "./store";

const data = (): JsonMap => now().document?.data ?? {};
const diagram = (): Diagram => now().document?.diagram ?? { nodes: [], wires: [], models: {}, moving: [] };
const nodeOf = (id: string): SignalNode | undefined => diagram().nodes.find((node) => node.id === id);

/** Names that a new block, part or model must not have. */
const taken =
  (section: string) =>
  (data: JsonMap): string[] =>
    (section === "models" ? ["models"] : ["blocks", "parts"]).flatMap((each) => Object.keys(mapAt(data, [each])));

/** The folder of a file, with the stroke at its end. */
const folder = (path: string): string => path.slice(0, path.lastIndexOf("/") + 1);

/** Files that a model can be read from, as the open diagram names them. */
export async function modelFiles(): Promise<string[]> {
  const answer = await ordered(() => get<{ files: FileEntry[] }>("api/files"));
  const here = folder(now().document?.path ?? "");
  return (answer?.files ?? [])
    .filter(({ path, kind }) => kind === "mechanism" && path.startsWith(here))
    .map(({ path }) => path.slice(here.length));
}

/** What a new block begins as: about the first model that there is, at its last frame. */
async function begun(item: BlockItem): Promise<Json> {
  if (!isMap(item.template)) return item.template;
  const value = { ...item.template };
  if (item.section === "models") return { ...value, file: (await modelFiles())[0] ?? value["file"] ?? "" };
  const { models } = diagram();
  const selected = now().selected.flatMap((id) => textAt(data(), [...(nodeOf(id)?.path ?? []), "model"]) ?? []);
  const model = selected[0] ?? Object.keys(mapAt(data(), ["models"])).at(-1) ?? "";
  if ("model" in value) value["model"] = model;
  if ("frame" in value) value["frame"] = models[model]?.frames.at(-1) ?? "";
  return value;
}

/**
 * Adds what a palette entry says; at a place if it was dropped there, beside the others if not.
 *
 * @returns Its id; undefined if it was refused.
 */
export async function addBlock(item: BlockItem, where?: Point): Promise<string | undefined> {
  const value = await begun(item);
  const idOf = (name: string): string => `${item.section}/${name}`;
  const name = await addEntry(item.section, item.name, taken(item.section), (name) => {
    if (where !== undefined) update((state) => ({ places: { ...state.places, [idOf(name)]: where } }));
    return value;
  });
  if (name === undefined) return undefined;
  const id = idOf(name);
  if (where !== undefined) await place({ [id]: where });
  update({ selected: [id], sight: { id } });
  return id;
}

/** A signal as files name it. */
export function signalName(node: SignalNode, port: string): string {
  // Of a block inside a part.
  if (node.kind === "part" && port.includes(".")) return `${node.title}/${port}`;
  return `${node.title}.${port}`;
}

/** The entry that says what feeds an input. */
function inputPath(node: SignalNode, port: string): Path {
  const wire = diagram().wires.find((each) => each.target === node.id && each.target_port === port);
  if (wire !== undefined) return wire.path;
  if (node.kind === "part" && port.includes(".")) return ["wires", `${node.title}/${port}`];
  return [...node.path, "inputs", port];
}

/** Leads an output to an input; what fed that before does no longer. */
export async function link(source: string, output: string, target: string, input: string): Promise<void> {
  const [from, to] = [nodeOf(source), nodeOf(target)];
  if (from === undefined || to === undefined) return;
  const value = signalName(from, output);
  await edit(`link ${value} to ${to.title}.${input}`, [{ op: "set", path: inputPath(to, input), value }]);
}

/** Adds a scope to a signal. */
export async function look(source: string, output: string): Promise<void> {
  const from = nodeOf(source);
  if (from === undefined) return;
  const signal = output.replaceAll(/\W/g, "_");
  const value = { kind: "scope", signals: [signal], inputs: { [signal]: signalName(from, output) } };
  const name = await addEntry("blocks", "scope", taken("blocks"), () => value);
  if (name !== undefined) update({ selected: [`blocks/${name}`], sight: { id: `blocks/${name}` } });
}

/** Takes blocks and wires away; wires go with the blocks that they join. */
export async function remove(ids: string[]): Promise<void> {
  const gone = new Set(ids);
  const { nodes, wires } = diagram();
  const edits: Edit[] = [
    ...wires.filter(({ id, source, target }) => !gone.has(target) && (gone.has(id) || gone.has(source))),
    ...wires.filter(({ path, target }) => gone.has(target) && path[0] === "wires"),
    ...nodes.filter(({ id }) => gone.has(id)),
  ].map(({ path }) => ({ op: "remove", path }));
  const one = ids.length === 1 ? (nodeOf(ids[0] ?? "")?.title ?? "a wire") : `${ids.length} elements`;
  await edit(`remove ${one}`, edits);
}
