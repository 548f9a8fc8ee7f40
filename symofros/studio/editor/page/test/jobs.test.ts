import { afterEach, beforeEach, expect, test, vi } from "vitest";

// What the modules ask of the browser when they are loaded.
vi.stubGlobal("window", {
  setTimeout: () => 0,
  location: { href: "http://127.0.0.1/" },
  matchMedia: () => ({ matches: false }),
});
const storage = { getItem: () => null, setItem: () => undefined };
vi.stubGlobal("localStorage", storage);
vi.stubGlobal("sessionStorage", storage);

const { hearSamples, run } = await import("../src/store/jobs");
const { now, update } = await import("../src/store/store");

const PLOTS = [{ title: "", xy: false, curves: [{ name: "slow.y", unit: "", signal: "slow.y" }] }];

function tell(id: string) {
  hearSamples({ id, plots: PLOTS, t: [], values: [] });
  hearSamples({ id, plots: null, t: [0, 0.5], values: [[1, 2]] });
}

function answer(id: string, before: () => void = () => undefined) {
  vi.stubGlobal("fetch", async () => {
    before();
    return new Response(JSON.stringify({ id }), { status: 200, headers: { "content-type": "application/json" } });
  });
}

// Runs are of the open document.
beforeEach(() => update({ jobs: {}, live: null, document: { path: "loop.yaml" } as never }));
afterEach(() => update({ jobs: {}, live: null, document: null }));

test("samples that come before the answer that names the run are kept", async () => {
  answer("a", () => tell("a"));
  void run("run");
  await vi.waitFor(() => expect(now().jobs.run?.id).toBe("a"));
  await vi.waitFor(() => expect(now().bottom).toBe("run"));
  expect(now().live).toMatchObject({ id: "a", t: [0, 0.5], values: { "slow.y": [1, 2] } });
});

test("samples of the run before are dropped", async () => {
  tell("a");
  answer("b");
  void run("run");
  await vi.waitFor(() => expect(now().jobs.run?.id).toBe("b"));
  await vi.waitFor(() => expect(now().live).toBeNull());
  hearSamples({ id: "a", plots: null, t: [1], values: [[3]] });
  expect(now().live).toBeNull();
});

test("samples of another page's run leave those of ours", async () => {
  answer("a", () => tell("a"));
  void run("run");
  await vi.waitFor(() => expect(now().jobs.run?.id).toBe("a"));
  tell("b");
  expect(now().live).toMatchObject({ id: "a", t: [0, 0.5] });
});
