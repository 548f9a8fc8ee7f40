// A model in WebAssembly beside MuJoCo's official module, in Node, side by side in one run; run by
// `python -m validation environments`, which compares the results with native C.
//
//     node race_wasm.mjs MODEL.mjs STATES.json [MODEL.xml]
//
// STATES.json: {"q", "v", "w": numbers state by state, "counts": states in a call, "turns"}; `w` is u of forward and a of
// inverse dynamics. MuJoCo is what `npm install @mujoco/mujoco` puts beside the working folder. Prints JSON: the versions,
// and of each function and count the results (of ours and of MuJoCo's) and the times of the turns [ns a state].
//
// Loops over calls are in JavaScript on both sides. MuJoCo takes one state a call, by the calls that its M and qfrc_bias need, without
// collisions: kinematics, comPos, makeM, comVel, rne; forward dynamics factors and solves, inverse dynamics is rne with
// accelerations.
import { createRequire } from "node:module";
import { readFileSync } from "node:fs";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

const [ours, given, theirs] = process.argv.slice(2);
if (!given) throw new Error("usage: node race_wasm.mjs MODEL.mjs STATES.json [MODEL.xml]");
const { q, v, w, counts, turns } = JSON.parse(readFileSync(given, "utf8"));
const { load, sizes } = await import(pathToFileURL(resolve(ours)).href);
const { nq, nv } = sizes;
const LEAST = 4e6; // What a turn takes at least [ns].
const THIRD = { forward_dynamics: "u", inverse_dynamics: "a" };
const OUTPUTS = { dynamics: ["M", "h"] };
const FUNCTIONS = ["dynamics", "forward_dynamics", "inverse_dynamics"];

/** Parts of n states each (n, size) side by side, state by state. */
function joined(parts, n) {
  const widths = parts.map((part) => part.length / n);
  const rows = Array.from({ length: n }, (_, i) =>
    parts.flatMap((part, k) => Array.from(part.subarray(i * widths[k], (i + 1) * widths[k]))),
  );
  return rows;
}

async function ourSide(name, n) {
  const batch = (await load()).prepareBatch(name, n); // A memory of its own.
  batch.inputs.q.set(q.slice(0, n * nq));
  batch.inputs.v.set(v.slice(0, n * nv));
  batch.inputs[THIRD[name]]?.set(w.slice(0, n * nv));
  const results = () => {
    batch.run();
    const names = OUTPUTS[name] ?? Object.keys(batch.outputs).slice(0, 1);
    return joined(names.map((each) => batch.outputs[each]), n);
  };
  return { call: batch.run, results };
}

async function mujocoSides() {
  const here = createRequire(join(process.cwd(), "package.json"));
  let place;
  try {
    place = here.resolve("@mujoco/mujoco");
  } catch {
    return { version: null };
  }
  const { default: loadMujoco } = await import(pathToFileURL(place).href);
  const { version } = JSON.parse(readFileSync(join(place, "..", "package.json")));
  const mujoco = await loadMujoco();
  const model = mujoco.MjModel.from_xml_string(readFileSync(theirs, "utf8")),
    data = new mujoco.MjData(model);
  if (model.nq !== nq || model.nv !== nv) throw new Error(`MuJoCo has ${model.nq}, ${model.nv} for nq ${nq}, nv ${nv}`);
  const bias = new mujoco.DoubleBuffer(nv),
    full = new mujoco.DoubleBuffer(nv * nv),
    solved = new mujoco.DoubleBuffer(nv);
  const states = Array.from({ length: Math.max(...counts) }, (_, i) => ({
    q: q.slice(i * nq, (i + 1) * nq),
    v: v.slice(i * nv, (i + 1) * nv),
    w: w.slice(i * nv, (i + 1) * nv),
  }));
  function posed(state) {
    data.qpos.set(state.q);
    data.qvel.set(state.v);
    mujoco.mj_kinematics(model, data);
    mujoco.mj_comPos(model, data);
  }
  const one = {
    dynamics(state) {
      posed(state);
      mujoco.mj_makeM(model, data);
      mujoco.mj_comVel(model, data);
      mujoco.mj_rne(model, data, 0, bias);
    },
    forward_dynamics(state) {
      this.dynamics(state);
      mujoco.mj_factorM(model, data);
      const h = bias.GetView();
      mujoco.mj_solveM(model, data, solved, state.w.map((force, k) => force - h[k]));
    },
    inverse_dynamics(state) {
      posed(state);
      mujoco.mj_comVel(model, data);
      data.qacc.set(state.w);
      mujoco.mj_rne(model, data, 1, bias);
    },
  };
  const results = {
    dynamics() {
      mujoco.mj_fullM(model, data, full);
      return [...full.GetView(), ...bias.GetView()];
    },
    forward_dynamics: () => [...solved.GetView()],
    inverse_dynamics: () => [...bias.GetView()],
  };
  const side = (name, n) => ({
    call() {
      for (let i = 0; i < n; ++i) one[name](states[i]);
    },
    results: () => states.slice(0, n).map((state) => (one[name](state), results[name]())),
  });
  return { version, side };
}

/** Of so many calls [ns]. */
function taken(side, rounds) {
  const start = process.hrtime.bigint();
  for (let k = 0; k < rounds; ++k) side.call();
  return Number(process.hrtime.bigint() - start);
}

const mujoco = theirs ? await mujocoSides() : { version: null };
const races = [];
for (const name of FUNCTIONS)
  for (const n of counts) {
    const sides = { symofros: await ourSide(name, n) };
    if (mujoco.side) sides["@mujoco/mujoco"] = mujoco.side(name, n);
    const results = Object.fromEntries(Object.entries(sides).map(([who, side]) => [who, side.results()]));
    for (const side of Object.values(sides)) for (let k = 0; k < 3; ++k) taken(side, 200 / n + 1); // V8 compiles.
    const rounds = Object.fromEntries(
      Object.entries(sides).map(([who, side]) => [who, Math.max(1, Math.ceil(LEAST / taken(side, 1)))]),
    );
    const times = Object.fromEntries(Object.keys(sides).map((who) => [who, []]));
    for (let turn = 0; turn < turns; ++turn)
      for (const [who, side] of Object.entries(sides)) times[who].push(taken(side, rounds[who]) / (rounds[who] * n));
    races.push({ function: name, states: n, results, times });
  }
console.log(JSON.stringify({ node: process.version, mujoco: mujoco.version, races }));
