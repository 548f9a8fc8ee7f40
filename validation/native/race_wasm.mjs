// M + h of a model in WebAssembly beside MuJoCo's official module, in Node, side by side in one run.
//
//     symofros export panda.urdf --target wasm -o panda_wasm;  symofros export panda.urdf --target mjcf -o panda_mjcf
//     npm install @mujoco/mujoco
//     node race_wasm.mjs panda_wasm/panda.mjs panda_mjcf/panda.xml
//
// Loops are in JavaScript on both sides, one state a call; ours is timed in batches of 64 and of 4096 states, too, with the
// loop in C.
// MuJoCo's are the calls that its M and qfrc_bias need, without collisions: kinematics, comPos, makeM, comVel, rne.
// Both get the same states (speeds and angles within 1); how far M and h differ is printed, and too much is an error.
import { createRequire } from "node:module";
import { readFileSync } from "node:fs";
import { join, resolve } from "node:path";
import { pathToFileURL } from "node:url";

const [ours, theirs] = process.argv.slice(2);
if (!theirs) throw new Error("usage: node race_wasm.mjs MODEL.mjs MODEL.xml");
const here = createRequire(join(process.cwd(), "package.json"));
const { default: loadMujoco } = await import(pathToFileURL(here.resolve("@mujoco/mujoco")).href);
const version = JSON.parse(readFileSync(join(here.resolve("@mujoco/mujoco"), "..", "package.json"))).version;
const { load } = await import(pathToFileURL(resolve(ours)).href);
const robot = await load(),
  mujoco = await loadMujoco();
const model = mujoco.MjModel.from_xml_string(readFileSync(theirs, "utf8")),
  data = new mujoco.MjData(model);
const { nq, nv } = robot.sizes,
  STATES = 64,
  MANY = 4096;
if (model.nq !== nq || model.nv !== nv)
  throw new Error(`nq ${nq}, nv ${nv} and MuJoCo's ${model.nq}, ${model.nv} differ`);

let seed = 1;
const random = () => (seed = (seed * 48271) % 2147483647) / 1073741823.5 - 1;
const states = Array.from({ length: STATES }, () => ({
  q: Float64Array.from({ length: nq }, random),
  v: Float64Array.from({ length: nv }, random),
}));
const prepare = async (n) => {
  const { inputs, outputs, run } = (await load()).prepareBatch("dynamics", n); // A memory of its own.
  for (let i = 0; i < n; ++i) {
    inputs.q.set(states[i % STATES].q, i * nq);
    inputs.v.set(states[i % STATES].v, i * nv);
  }
  return { inputs, outputs, run };
};
const [one, batch, large] = [await prepare(1), await prepare(STATES), await prepare(MANY)];

const bias = new mujoco.DoubleBuffer(nv),
  full = new mujoco.DoubleBuffer(nv * nv);
function mujocoState({ q, v }) {
  data.qpos.set(q);
  data.qvel.set(v);
  mujoco.mj_kinematics(model, data);
  mujoco.mj_comPos(model, data);
  mujoco.mj_makeM(model, data);
  mujoco.mj_comVel(model, data);
  mujoco.mj_rne(model, data, 0, bias);
}
function ourState({ q, v }) {
  one.inputs.q.set(q);
  one.inputs.v.set(v);
  one.run();
}

const worst = { M: 0, h: 0 };
batch.run();
states.forEach((state, i) => {
  mujocoState(state);
  mujoco.mj_fullM(model, data, full);
  const [M, h] = [full.GetView(), bias.GetView()];
  for (let k = 0; k < nv * nv; ++k) worst.M = Math.max(worst.M, Math.abs(M[k] - batch.outputs.M[i * nv * nv + k]));
  for (let k = 0; k < nv; ++k) worst.h = Math.max(worst.h, Math.abs(h[k] - batch.outputs.h[i * nv + k]));
});
console.log(`largest differences: M ${worst.M.toExponential(1)}, h ${worst.h.toExponential(1)}`);
if (!(Math.max(worst.M, worst.h) < 1e-6)) throw new Error("the two are not of one mechanism");

// Interleaved, the least of many turns: other work on the machine only lengthens a turn.
const turns = {
  "symofros, 64 states a call": () => {
    for (let k = 0; k < 40; ++k) batch.run();
    return 40 * STATES;
  },
  "symofros, 4096 states a call": () => {
    large.run();
    return MANY;
  },
  "symofros, one state a call": () => {
    for (let k = 0; k < 20; ++k) states.forEach(ourState);
    return 20 * STATES;
  },
  [`@mujoco/mujoco ${version}`]: () => {
    for (let k = 0; k < 5; ++k) states.forEach(mujocoState);
    return 5 * STATES;
  },
};
const least = Object.fromEntries(Object.keys(turns).map((name) => [name, Infinity]));
for (let turn = 0; turn < 200; ++turn)
  for (const [name, run] of Object.entries(turns)) {
    const start = process.hrtime.bigint(),
      count = run();
    least[name] = Math.min(least[name], Number(process.hrtime.bigint() - start) / count);
  }
console.log(`node ${process.version}, M + h, ns a state:`);
for (const [name, ns] of Object.entries(least)) console.log(`  ${name.padEnd(30)} ${ns.toFixed(0)}`);
