// $name: efforts, reactions and section forces of a mechanism, in WebAssembly. Written by lagrange_casadi $version, scene $scene.
// README.wasm.md says how it is used; $p.d.ts says the same to TypeScript.

export const contract = $contract;

$engine
/** Why there is no result: `status` is the number, the message says what it means. */
export class MechanismError extends Error {
  constructor(status, message) {
    super(message);
    this.name = "MechanismError";
    this.status = status;
  }
}

export class Mechanism {
  #engine;

  constructor(instance) {
    const { prefix, precision, model, parameters, inputs, outputs, forces } = contract;
    const layout = { prefix, precision, model, parameters: parameters.length, inputs: inputs.length, outputs: outputs.length, forces: forces.length };
    this.#engine = new Engine(instance, layout);
    this.prepare();
  }

  /** Take parameters by name, the defaults for those that are left out, and begin anew. */
  prepare(parameters = {}) {
    for (const name of Object.keys(parameters)) {
      if (!contract.parameters.some((one) => one.name === name)) {
        throw new TypeError("unknown parameter '" + name + "'; valid: " + contract.parameters.map((one) => one.name).join(", "));
      }
    }
    this.#check(this.#engine.prepare(contract.parameters.map((one) => own(parameters, one.name) ?? one.default)));
  }

  /** The inputs that the scene's motion prescribes at a time [s]. */
  motion(time) {
    this.#engine.fit(1);
    this.#check(this.#engine.motion(time));
    return named(contract.inputs, this.#engine.inputs);
  }

  /** The outputs for inputs by name; of those that are left out, 0 is taken. */
  evaluate(inputs) {
    this.#engine.fit(1);
    this.#engine.inputs.set(contract.inputs.map((one) => own(inputs, one.name) ?? 0));
    this.#check(this.#engine.evaluate());
    return named(contract.outputs, this.#engine.outputs);
  }

  /** The forces inside a link at the ratio xi/l, from 0 at its base to 1 at its tip, for outputs of this mechanism as it is prepared. */
  section(outputs, link, xi) {
    const number = contract.links.indexOf(link);
    if (number < 0) throw new TypeError("unknown link '" + link + "'; valid: " + contract.links.join(", "));
    this.#engine.fit(1);
    this.#engine.outputs.set(contract.outputs.map((one) => outputs[one.name]));
    const forces = this.#engine.section(number, xi);
    this.#check(this.#engine.failed);
    return named(contract.forces, forces);
  }

  /** All outputs at times [s] of the scene's motion, one after another: an array each, and the status of each instant, 0 where all is
   *  well. Outputs of an instant that has no result are NaN. */
  cycle(times) {
    const engine = this.#engine;
    engine.fit(times.length);
    for (let i = 0; i < times.length; i += 1) engine.motion(times[i], i);
    engine.evaluate();
    const many = contract.outputs.length;
    const values = engine.outputs;
    const found = contract.outputs.map((one, k) => [one.name, Float64Array.from({ length: times.length }, (_, i) => values[i * many + k])]);
    return { statuses: engine.statuses.slice(), outputs: Object.fromEntries(found) };
  }

  #check(status) {
    if (status) throw new MechanismError(status, this.#engine.message(status));
  }
}

/** A value by its name; what every object inherits, as `constructor`, is none. */
function own(values, name) {
  return Object.hasOwn(values, name) ? values[name] : undefined;
}

function named(members, values) {
  return Object.fromEntries(members.map((one, k) => [one.name, values[k]]));
}

/** A mechanism of its own, from the module: its bytes, an answer of fetch, or an address; by default the file beside this one. */
export async function load(source = new URL("./$p.wasm", import.meta.url)) {
  const found = await (typeof source === "string" || source instanceof URL ? fetch(source) : source);
  const bytes = typeof Response === "function" && found instanceof Response ? await answered(found) : found;
  const { instance } = await WebAssembly.instantiate(bytes, {});
  return new Mechanism(instance);
}

async function answered(response) {
  if (!response.ok) throw new Error("cannot load " + response.url + ": " + response.status);
  return response.arrayBuffer();
}
