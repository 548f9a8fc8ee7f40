// A model in WebAssembly: functions of arrays, batches, and instances that simulate. No server, no dependencies.
//
//     const model = await Model.load(bytes);
//     const { M, h, Q } = model.evaluate("dynamics", { q, v, u });
//     const arm = model.instance();  arm.u[0] = 1.5;  arm.advance(2.0);  arm.q;
//
// Arrays are Float64Array, matrices row by row; q, v, u, par, a, lam of an instance are views of its memory, to be taken anew
// after other calls: memory that grows ends them. Instances and prepared batches keep their memory until `free()`; a model
// keeps that of the last call of each function.

// Of 32-bit memory; a multiplication in JavaScript would pass it unnoticed.
const MOST_BYTES = 2 ** 31;

/** A number of states. */
function count(n) {
  if (!Number.isInteger(n) || n < 0) throw new RangeError(`a batch has ${n} states; it takes a whole number`);
  return n;
}

export class Model {
  /** Compile a module and read what it has. `bytes`: the .wasm file. */
  static async load(bytes) {
    const { instance } = await WebAssembly.instantiate(bytes, {});
    return new Model(instance.exports);
  }

  constructor(exports) {
    this.wasm = exports;
    exports._initialize?.();
    this.functions = [];
    for (let i = 0; i < exports.js_functions(); ++i) this.functions.push(this.#read(i));
    // Names that inputs may have; the first array of each function is of parameters, which are an instance's.
    this.inputs = new Set(["q", "v", "u", "a", "t", ...this.functions.flatMap((f) => f.in.slice(1).map((a) => a.name))]);
    this.work = this.allocate(8 * Math.max(1, exports.js_size(1)));
    this.pre = this.allocate(8 * Math.max(1, exports.js_size(0)));
    this.par = exports.js_constant(0);
    exports.js_prepare(this.par, this.pre);
    this.buffers = new Map();
  }

  /** Worst relative error at the reference points that the NumPy interpreter computed at export. */
  selftest() { return this.wasm.js_selftest(); }

  /** A function by its name, and the frame of a function of frames. */
  find(name, frame = null) {
    const match = this.functions.find((f) => f.name === name && f.frame === frame);
    if (match) return match;
    const names = [...new Set(this.functions.map((f) => f.name))].join(", ");
    throw new RangeError(`no function '${name}'${frame ? ` of frame '${frame}'` : ""}; there are: ${names}`);
  }

  /** Evaluate a function of one state. `inputs`: arrays by name; t, u and others that are left out are zero; quaternions
   *  are of unit length, which is not looked at. Parameters are the defaults; an instance has its own. Returns the outputs
   *  by name, as copies. */
  evaluate(name, inputs = {}, frame = null) {
    const f = this.find(name, frame), call = this.#call(f, 1);
    this.#fill(f, call, inputs, 1);
    this.wasm.js_evaluate(f.index, call.in, call.out, this.work);
    return this.#results(f, call, 1);
  }

  /** Evaluate a function of n states, arrays state by state; several are computed at a time. */
  batch(name, n, inputs, frame = null) {
    const f = this.find(name, frame), call = this.#call(f, count(n));
    this.#fill(f, call, inputs, n);
    this.wasm.js_batch(f.index, n, call.in, call.stride, call.out, this.work);
    return this.#results(f, call, n);
  }

  /** A batch whose memory is kept until `free()`: fill `inputs`, `run()`, read `outputs`; nothing is copied. Memory that
   *  grows ends the arrays that were taken from it: `run()` throws until such `inputs` are taken anew. */
  prepareBatch(name, n, frame = null) {
    const f = this.find(name, frame), call = this.#made(f, count(n));
    const check = () => { if (!call.memory.length) throw new Error(`${name}: the batch was freed`); };
    const ended = (view) => view.buffer !== this.wasm.memory.buffer;
    const views = (arrays, at, taken) => Object.defineProperties({}, Object.fromEntries(arrays.map((a, k) => {
      const get = () => {
        check();
        if (!taken.has(a.name) || ended(taken.get(a.name))) taken.set(a.name, this.view(at[k], n * a.size));
        return taken.get(a.name);
      };
      return [a.name, { get, enumerable: true }];
    })));
    const given = new Map();
    return {
      inputs: views(f.in.slice(1), call.inputs.slice(1), given), outputs: views(f.out, call.outputs, new Map()),
      run: () => {
        check();
        const lost = [...given.keys()].filter((key) => ended(given.get(key))).join(", ");
        if (lost) throw new Error(`${name}: memory has grown since ${lost} were taken; take them from 'inputs' anew`);
        this.wasm.js_batch(f.index, n, call.in, call.stride, call.out, this.work);
      },
      free: () => this.#free(call),
    };
  }

  /** A simulated model with its own state and parameters. */
  instance() { return new Instance(this); }

  /** Address of new memory; throws where there is none left. */
  allocate(bytes) {
    const at = bytes <= MOST_BYTES ? this.wasm.js_allocate(bytes) : 0;
    if (!at) throw new RangeError(`no memory for ${bytes} bytes`);
    return at;
  }

  /** A view of n doubles in memory. */
  view(at, n) { return new Float64Array(this.wasm.memory.buffer, at, n); }

  text(at) {
    if (!at) return null;
    const bytes = new Uint8Array(this.wasm.memory.buffer, at);
    return new TextDecoder().decode(bytes.slice(0, bytes.indexOf(0)));
  }

  #read(index) {
    const w = this.wasm;
    const arrays = (out) => Array.from({ length: w.js_arrays(index, out) }, (_, k) => {
      const [rows, cols] = [w.js_array_rows(index, out, k), w.js_array_cols(index, out, k)];
      return { name: this.text(w.js_array_name(index, out, k)), rows, cols, size: rows * cols };
    });
    const frame = this.text(w.js_function_frame(index));
    return { index, name: this.text(w.js_function_name(index)), frame, in: arrays(0), out: arrays(1) };
  }

  /** Memory of a function's arrays for n states, kept until the function is called for another number of them. */
  #call(f, n) {
    const kept = this.buffers.get(f.index);
    if (kept?.n === n) return kept;
    if (kept) {
      this.buffers.delete(f.index);
      this.#free(kept);
    }
    const call = this.#made(f, n);
    this.buffers.set(f.index, call);
    return call;
  }

  #made(f, n) {
    const call = { n, memory: [] };
    const allocate = (bytes) => {
      const at = this.allocate(bytes);
      call.memory.push(at);
      return at;
    };
    const pointers = (values) => {
      const at = allocate(4 * Math.max(1, values.length));
      new Uint32Array(this.wasm.memory.buffer, at, values.length).set(values);
      return at;
    };
    const array = (a) => allocate(8 * Math.max(1, n * a.size));
    try {
      call.inputs = f.in.map((a, k) => (k === 0 ? this.pre : array(a)));
      call.outputs = f.out.map(array);
      call.in = pointers(call.inputs);
      call.out = pointers(call.outputs);
      call.stride = pointers(f.in.map((a, k) => (k === 0 ? 0 : a.size)));
    } catch (error) {
      this.#free(call); // What was there before the memory ran out.
      throw error;
    }
    return call;
  }

  #free(call) {
    for (const at of call.memory.splice(0)) this.wasm.js_free(at);
  }

  #fill(f, call, inputs, n) {
    const unknown = Object.keys(inputs).find((name) => !this.inputs.has(name));
    if (unknown !== undefined)
      throw new RangeError(`${f.name} takes no '${unknown}'; inputs are ${[...this.inputs].join(", ")}. Parameters are those`
        + " of an instance: set its 'par', call its prepare() and evaluate()");
    f.in.forEach((a, k) => {
      if (k === 0) return;
      const given = inputs[a.name], at = this.view(call.inputs[k], n * a.size);
      if (given === undefined) at.fill(0);
      else if (typeof given === "number") at.fill(given);
      else if (given.length === n * a.size) at.set(given);
      else throw new RangeError(`${f.name}: '${a.name}' has ${given.length} numbers; it takes ${n * a.size}`);
    });
  }

  #results(f, call, n) {
    return Object.fromEntries(f.out.map((a, k) => [a.name, this.view(call.outputs[k], n * a.size).slice()]));
  }
}

export class Instance {
  #address;

  constructor(model) {
    this.model = model;
    this.#address = model.wasm.js_instance();
    if (!this.#address) throw new Error("no memory for an instance");
    const size = (name) => model.sizes?.[name] ?? 0;
    this.sizes = [size("nq"), size("nv"), size("nu"), size("npar"), size("nv"), size("nc")];
  }

  /** Give the memory back: whatever is asked of the instance then throws. Arrays taken from it are not to be used. */
  free() {
    if (this.#address) this.model.wasm.js_free(this.#address);
    this.#address = 0;
  }

  /** Address of the instance in memory; throws after `free()`. */
  get at() {
    if (!this.#address) throw new Error("the instance was freed");
    return this.#address;
  }

  get t() { return this.model.wasm.js_time(this.at); }
  set t(value) { this.model.wasm.js_set_time(this.at, value); }
  get q() { return this.#array(0); }
  get v() { return this.#array(1); }
  get u() { return this.#array(2); }
  get par() { return this.#array(3); }
  get a() { return this.#array(4); }
  get lam() { return this.#array(5); }

  /** Parameters, state and inputs as at the start. */
  reset() { this.model.wasm.js_reset(this.at); }

  /** Take changed parameters; throws where they violate a condition of the description. */
  prepare() {
    if (this.model.wasm.js_set_parameters(this.at) < 0)
      throw new RangeError(`refused: ${this.model.text(this.model.wasm.js_refused(this.at))}`);
  }

  /** Bring the state onto the constraints, and quaternions near unit length to it. */
  project() { this.#check(this.model.wasm.js_project(this.at), "project"); }

  /** Accelerations `a` and multipliers `lam` at the present state. */
  accelerate() { this.#check(this.model.wasm.js_accelerate(this.at), "accelerate"); return this.a; }

  /** Simulate to `tEnd` [s] by steps of at most `dt` [s]; by default that of the export. */
  advance(tEnd, dt = 0) { this.#check(this.model.wasm.js_advance(this.at, tEnd, dt), "advance"); }

  /** A function of the model at the present state, whose quaternions are of unit length: `project()`, `advance()`. */
  evaluate(name, frame = null) {
    // Copies: views of memory end where it grows.
    const [q, v, u, a] = [this.q, this.v, this.u, this.a].map((x) => x.slice()), inputs = { q, v, u, a, t: this.t };
    const { model } = this, pre = model.wasm.js_array(this.at, 6), n = model.wasm.js_size(0);
    const shared = model.view(model.pre, n).slice();
    model.view(model.pre, n).set(model.view(pre, n)); // An instance has parameters of its own.
    try {
      return model.evaluate(name, inputs, frame);
    } finally {
      model.view(model.pre, n).set(shared); // Also where there is no such function.
    }
  }

  #array(what) { return this.model.view(this.model.wasm.js_array(this.at, what), this.sizes[what]); }

  #check(status, what) {
    if (status < 0) throw new Error(`${what} ended at t = ${this.t} s: ${STATUSES[status]} (status ${status})`);
  }
}
