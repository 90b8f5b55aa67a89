// $name, for TypeScript. Written by lagrange_casadi $version, scene $scene.

/** Numbers that may change. */
export interface Parameters {
$parameters
}

/** The motion of the drives at an instant. */
export interface Inputs {
$inputs
}

/** What follows from it. */
export interface Outputs {
$outputs
}

/** What the part of a link towards the tip does to the part towards the base. */
export interface Forces {
$forces
}

export type Link = $links;

/** What a member is: its name here, its place in a file of results, its unit and its meaning. */
export interface Member {
  readonly name: string;
  readonly path: string;
  readonly unit: string;
  readonly meaning: string;
}

export declare const contract: {
  readonly name: string;
  readonly prefix: string;
  readonly precision: "double" | "single";
  readonly model: number;
  readonly parameters: readonly (Member & { readonly default: number; readonly low: number | null; readonly high: number | null })[];
  readonly inputs: readonly Member[];
  readonly outputs: readonly Member[];
  readonly links: readonly Link[];
  readonly forces: readonly { readonly name: keyof Forces; readonly unit: string; readonly meaning: string }[];
};

/** Why there is no result: `status` is the number, the message says what it means. */
export declare class MechanismError extends Error {
  readonly status: number;
}

export declare class Mechanism {
  private constructor();
  /** Take parameters by name, the defaults for those that are left out, and begin anew. */
  prepare(parameters?: Partial<Parameters>): void;
  /** The inputs that the scene's motion prescribes at a time [s]. */
  motion(time: number): Inputs;
  /** The outputs for inputs by name; of those that are left out, 0 is taken. */
  evaluate(inputs: Partial<Inputs>): Outputs;
  /** The forces inside a link at the ratio xi/l, from 0 at its base to 1 at its tip, for outputs of this mechanism as it is prepared. */
  section(outputs: Outputs, link: Link, xi: number): Forces;
  /** All outputs at times [s] of the scene's motion, one after another: an array each, and the status of each instant. */
  cycle(times: ArrayLike<number>): { statuses: Int32Array; outputs: Record<keyof Outputs, Float64Array> };
}

/** A mechanism of its own, from the module: its bytes, an answer of fetch, or an address; by default the file beside the script. */
export declare function load(source?: BufferSource | Response | Promise<Response> | URL | string): Promise<Mechanism>;
