import { beforeEach, expect, test, vi } from "vitest";

import type { Job } from "../src/api/jobs";
import type { Edit, JsonMap, View } from "../src/api/types";
import type { Moves } from "../src/model/moves";
import { expected } from "../src/model/pose";

// What the modules ask of the browser when they are loaded.
const storage = { getItem: () => null, setItem: () => undefined };
vi.stubGlobal("window", {
  setTimeout: () => 0,
  location: { href: "http://127.0.0.1/" },
  matchMedia: () => ({ matches: false }),
});
vi.stubGlobal("localStorage", storage);
vi.stubGlobal("sessionStorage", storage);

const { add } = await import("../src/store/bodies");
const { addEntry, edit, moveBlocks, redo, undo } = await import("../src/store/edits");
const { open } = await import("../src/store/files");
const { hear, run } = await import("../src/store/jobs");
const { identity } = await import("../src/store/renamed");
const { closing, now, OF_NEW_DOCUMENT, show, update } = await import("../src/store/store");
const { look, move, shownView } = await import("../src/store/view");

interface Asked {
  address: string;
  body: JsonMap & { edits?: Edit[] };
  answer(body: object, status?: number): void;
}

/** Requests that wait for their answers. */
let asked: Asked[] = [];
let [revision, data]: [number, JsonMap] = [0, {}];

const made = (path = "arm.yaml"): JsonMap => ({
  path,
  name: path,
  revision,
  step: revision,
  data,
  dirty: revision > 0,
  layout: {},
  text: "",
  problems: [],
  parameters: [],
  graph: { nodes: [], edges: [] },
  diagram: null,
});

/** Answers the oldest request: the server makes its edits. */
async function answer(body?: object, status = 200): Promise<Asked> {
  await vi.waitFor(() => expect(asked.length).toBeGreaterThan(0));
  const request = asked.shift() as Asked;
  if (request.address === "api/edit" && status === 200)
    for (const each of request.body.edits ?? []) {
      const [section, name] = each.path.map(String) as [string, string];
      const { [name]: old, ...others } = (data[section] ?? {}) as JsonMap;
      const value = each.op === "set" && "value" in each ? each.value : (old ?? null);
      data = { ...data, [section]: { ...others, [each.op === "rename" ? each.to : name]: value } };
    }
  if (body === undefined) revision += 1;
  request.answer(body ?? made(), status);
  await settled();
  return request;
}

const settled = (): Promise<void> => new Promise((done) => setTimeout(done, 0));

beforeEach(() => {
  [asked, revision, data] = [[], 0, { parameters: {}, bodies: {} }];
  const fetched = (address: string, { body }: { body: string | null }): Promise<Response> =>
    new Promise((take) => {
      const answer = (content: object, status = 200): void => take(Response.json(content, { status }));
      asked.push({ address, body: JSON.parse(body ?? "{}") as JsonMap, answer });
    });
  vi.stubGlobal("fetch", fetched);
  update({ ...OF_NEW_DOCUMENT, document: made() as never, dialog: null, notices: [] });
});

test("what is added twice before the server answers has two names", async () => {
  void addEntry(
    "parameters",
    "p1",
    ({ parameters }) => Object.keys(parameters as JsonMap),
    () => 1,
  );
  void addEntry(
    "parameters",
    "p1",
    ({ parameters }) => Object.keys(parameters as JsonMap),
    () => 1,
  );
  await answer();
  await answer();
  expect(data["parameters"]).toEqual({ p1: 1, p2: 1 });
});

test("two bodies of two quick clicks are two, both on what was chosen", async () => {
  update({ selected: ["bodies/base"] });
  const template = { joint: { kind: "revolute" } };
  const item = { kind: "rigid_body", title: "", help: "", section: "bodies", name: "arm", template } as never;
  void add(item);
  void add(item);
  await answer();
  await answer();
  const joint = { kind: "revolute", parent: "base" };
  expect(data["bodies"]).toEqual({
    arm: { joint: { ...joint, name: "q1" } },
    arm2: { joint: { ...joint, name: "q2" } },
  });
});

test("an edit of what is being renamed is of its new name, and its row stays", async () => {
  data = { parameters: { p1: 1 } };
  const before = identity(["parameters", "p1"]);
  void edit("rename p1", [{ op: "rename", path: ["parameters", "p1"], to: "mass" }]);
  void edit("change p1", [{ op: "set", path: ["parameters", "p1"], value: 5 }]);
  await answer();
  expect(identity(["parameters", "mass"])).toBe(before);
  await answer();
  expect(data["parameters"]).toEqual({ mass: 5 });
  void edit("change p1", [{ op: "set", path: ["parameters", "p1"], value: 2 }]);
  expect((await answer()).body.edits).toEqual([{ op: "set", path: ["parameters", "p1"], value: 2 }]);
});

test("a renaming that is refused is followed by nothing", async () => {
  void edit("rename p1", [{ op: "rename", path: ["parameters", "p1"], to: "dq" }]);
  void edit("change p1", [{ op: "set", path: ["parameters", "p1"], value: 5 }]);
  await answer({ error: { object: "dq", found: "", rule: "", remedy: "" } }, 422);
  expect((await answer()).body.edits).toEqual([{ op: "set", path: ["parameters", "p1"], value: 5 }]);
});

test("undo takes back what was done before it, not what is done after", async () => {
  void edit("first", [{ op: "set", path: ["parameters", "a"], value: 1 }]);
  void undo();
  void edit("second", [{ op: "set", path: ["parameters", "b"], value: 1 }]);
  expect((await answer()).body["label"]).toBe("first");
  expect((await answer()).address).toBe("api/undo");
  expect((await answer()).body["label"]).toBe("second");
});

test("two quick steps back take back two things, in their order", async () => {
  update({ places: { "bodies/a": [0, 0] } });
  void moveBlocks({ "bodies/a": [8, 8] });
  await answer({});
  data = { parameters: {} };
  void edit("later", [{ op: "set", path: ["parameters", "a"], value: 1 }]);
  await answer();
  void undo();
  void undo();
  revision = -1; // As it was before the edit.
  expect((await answer()).address).toBe("api/undo");
  expect(await answer({})).toMatchObject({ address: "api/layout", body: { positions: { "bodies/a": [0, 0] } } });
  expect(now().places).toMatchObject({ "bodies/a": [0, 0] });
  expect((now().moves as Moves).undone).toHaveLength(1);
  void redo();
  await answer({});
  expect(now().places).toMatchObject({ "bodies/a": [8, 8] });
});

test("work that is on its way is asked about before another file is opened", async () => {
  void edit("change", [{ op: "set", path: ["parameters", "a"], value: 1 }]);
  void open("other.yaml");
  await answer();
  expect(now().dialog?.kind).toBe("discard");
  expect(asked).toEqual([]);
});

test("an answer closes the window that asked, and no later one", async () => {
  show({ kind: "save as" });
  const close = closing();
  show({ kind: "keys" });
  expect(close()).toBe(false);
  expect(now().dialog).toEqual({ kind: "keys" });
});

test("an element that is added opens its window, but not over another", async () => {
  const item = { kind: "closure", title: "", help: "", section: "closures", name: "loop", template: {} } as never;
  void add(item);
  await answer();
  expect(now().dialog).toEqual({ kind: "properties", path: ["closures", "loop"] });
  show({ kind: "search" });
  void add(item);
  await answer();
  expect(now().dialog).toEqual({ kind: "search" });
});

test("a double click starts one job", async () => {
  void run("compile");
  void run("compile");
  await answer({ id: "1" });
  await settled();
  expect(asked).toEqual([]);
  expect(now().jobs.compile?.id).toBe("1");
});

test("a job that is over stays so, whatever comes late", async () => {
  const job = { id: "1", kind: "compile", revision: 0, state: "running", result: null, error: null } as unknown as Job;
  update({ jobs: { compile: job } });
  hear({ ...job, state: "done" });
  await answer({ ...job, state: "done", result: {} });
  expect(now().jobs.compile?.state).toBe("done");
  hear(job);
  expect(now().jobs.compile?.state).toBe("done");
});

test("a job that an earlier page has started is shown, and can be cancelled", () => {
  const job = { id: "7", kind: "simulate", revision: 0, state: "running", result: null, error: null };
  hear({ ...job, path: "other.yaml" } as unknown as Job);
  expect(now().jobs.simulate).toBeUndefined();
  hear({ ...job, path: now().document?.path } as unknown as Job);
  expect(now().jobs.simulate?.id).toBe("7");
});

const stand = (q1: number) => ({ q: { q1 }, exaggeration: 1, frames: false, forces: false, gap: null, beams: [] });
const refusal = { error: { object: "", found: "", rule: "", remedy: "" } };
const slider = (): number | undefined => expected(shownView() as View, now().posing).q["q1"];

test("a slider stands where it was put until the view does", async () => {
  update({ view: { address: "view/", ...stand(0) } as unknown as View });
  void move({ q: { q1: 1 } });
  void move({ q: { q1: 2 }, frames: true });
  expect(slider()).toBe(2);
  await answer({ ...stand(1), why: "" });
  expect(slider()).toBe(2);
  expect(expected(shownView() as View, now().posing).frames).toBe(true);
  await answer({ ...stand(1.5), why: "a loop" }); // As near as it gets.
  expect([slider(), now().stuck]).toEqual([1.5, "a loop"]);
});

test("a pose that is refused takes no later one with it, and no slider stays there", async () => {
  update({ view: { address: "view/", ...stand(0) } as unknown as View });
  void move({ q: { q1: 1 } });
  void move({ dark: true });
  await answer(refusal, 422);
  expect(slider()).toBe(0);
  expect((await answer({ ...stand(0), why: "" })).body).toMatchObject({ dark: true });
});

test("a reset is after the sliders that wait", async () => {
  void move({ dark: true });
  void move({ q: { q1: 1 }, dark: false });
  void move({ reset: true });
  await answer({ ...stand(0), why: "" });
  expect((await answer({ ...stand(0), why: "" })).body).toEqual({ reset: true, dark: false });
});

test("a picture that was asked for before a pose is not taken for one after it", async () => {
  void look();
  void move({ q: { q1: 1 } });
  const [picture] = asked.splice(0, 1);
  await answer({ ...stand(1), why: "" });
  asked.push(picture as Asked);
  await answer({ address: "view/", ...stand(0) });
  await answer({ ...stand(1), why: "" });
  expect(slider()).toBe(1);
});

test("what waits for a view is of the document that it was asked for", async () => {
  void move({ q: { q1: 1 } });
  void move({ q: { q1: 2 } });
  update({ ...OF_NEW_DOCUMENT, document: made("other.yaml") as never });
  await answer({ ...stand(1), why: "" });
  expect([asked, now().posing]).toEqual([[], {}]);
});
