// A diagram in WebAssembly: a controller, a plant, or both. No server, no dependencies.
//
//     const program = await load();
//     const it = program.instance();
//     it.set("goal", [0.5, -0.2]);  it.advance(0.001);  it.get("effort");
//
// Inputs are the inlets of the diagram, outputs its outlets; run-time parameters bear their names in it, such as "pd.kp".
// Instances keep their memory until `free()`.

// Statuses of the stepping loop.
const TERMINAL_EVENT = 3, PARAMETERS = 2;

export class Program {
  /** Compile a module. `bytes`: the .wasm file; `tables`: the names of its inputs, outputs and parameters. */
  static async load(bytes, tables) {
    const { instance } = await WebAssembly.instantiate(bytes, {});
    return new Program(instance.exports, tables);
  }

  constructor(exports, { inputs, outputs, parameters, period }) {
    this.wasm = exports;
    exports._initialize?.();
    Object.assign(this, { inputs, outputs, parameters, period });
  }

  /** The diagram at its start, with states and parameters of its own. */
  instance() { return new Instance(this); }

  /** Where a quantity lies: the number of its array, its place there and its width. */
  find(name, ...tables) {
    for (const [what, table] of [this.inputs, this.outputs, this.parameters].entries())
      if (tables.includes(what) && Object.hasOwn(table, name)) return { what, ...table[name] };
    const known = tables.flatMap((what) => Object.keys([this.inputs, this.outputs, this.parameters][what]));
    throw new RangeError(`no '${name}'; there are: ${known.join(", ") || "none"}`);
  }
}

export class Instance {
  #address;

  constructor(program) {
    this.program = program;
    this.#address = program.wasm.js_instance();
    if (!this.#address) throw new Error("no memory for an instance, or no first state on the constraints");
  }

  /** Give the memory back: whatever is asked of the instance then throws. */
  free() {
    if (this.#address) this.program.wasm.js_free(this.#address);
    this.#address = 0;
  }

  /** Address of the instance in memory; throws after `free()`. */
  get at() {
    if (!this.#address) throw new Error("the instance was freed");
    return this.#address;
  }

  /** Present time [s]. */
  get t() { return this.program.wasm.js_time(this.at); }

  /** A copy of an input, an output or a parameter. Outputs are those of the last `advance` or `evaluate`; parameters are what
   *  actions of events have set them to. */
  get(name) {
    const place = this.program.find(name, 0, 1, PARAMETERS), value = this.#view(place).slice();
    return place.what === PARAMETERS ? value.map((_, i) => this.program.wasm.js_present(this.at, place.at + i)) : value;
  }

  /** Set an input, which holds until it is set anew, or a parameter, which counts from `prepare()` or `start()` on, also
   *  where actions of events have changed it: a number for all entries, or one number each. */
  set(name, value) {
    const place = this.program.find(name, 0, PARAMETERS);
    const numbers = typeof value === "number" ? Array(place.width).fill(value) : Array.from(value);
    if (numbers.length !== place.width || !numbers.every(Number.isFinite))
      throw new RangeError(`'${name}' takes ${place.width} finite numbers; it was given ${numbers.join(", ") || "none"}`);
    if (place.what !== PARAMETERS) this.#view(place).set(numbers);
    else numbers.forEach((x, i) => this.program.wasm.js_set(this.at, place.at + i, x));
  }

  /** Begin at t = 0 with the present parameters and inputs. */
  start() { this.#check(this.program.wasm.js_start(this.at), "start"); }

  /** Take changed parameters; throws where they violate a condition of a description. */
  prepare() { this.#check(this.program.wasm.js_prepare(this.at), "prepare"); }

  /** Outputs at the present time, of the inputs as they are now, while what is sampled holds. */
  evaluate() { this.#check(this.program.wasm.js_evaluate(this.at), "evaluate"); }

  /** Go on to time t [s], samples at t included. Returns whether the motion goes on; false: an event has ended it. */
  advance(t) { return this.#go(t, 0); }

  /** The same, but what is sampled at t waits for the next call: inputs that are set between count there. */
  approach(t) { return this.#go(t, 1); }

  #go(t, beforeSamples) {
    if (!(t >= this.t && t < Infinity)) throw new RangeError(`t = ${t} s lies before ${this.t} s, or is no time`);
    return this.#check(this.program.wasm.js_advance(this.at, t, beforeSamples), "advance") !== TERMINAL_EVENT;
  }

  // Views of memory end where it grows: none is kept.
  #view({ what, at, width }) {
    const { wasm } = this.program;
    return new Float64Array(wasm.memory.buffer, wasm.js_array(this.at, what) + 8 * at, width);
  }

  #check(status, what) {
    if (status >= 0) return status;
    const { wasm } = this.program, at = wasm.js_refused(this.at);
    if (at) {
      const bytes = new Uint8Array(wasm.memory.buffer, at);
      throw new RangeError(`refused: ${new TextDecoder().decode(bytes.slice(0, bytes.indexOf(0)))}`);
    }
    throw new Error(`${what} ended at t = ${this.t} s: ${STATUSES[status]} (status ${status})`);
  }
}
