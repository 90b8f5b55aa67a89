// How the module of an exported mechanism is called: where in its memory numbers are put, and where they are read.

/** A mechanism as WebAssembly. Its views of numbers hold until the next call that makes room. */
class Engine {
  /** `layout` has how many numbers each struct of the C holds, how many bytes a model takes, the prefix and the precision; and for how
   *  many numbers `more` there is room for whoever has calls of its own. */
  constructor(instance, layout) {
    this.calls = instance.exports;
    this.layout = layout;
    this.calls._initialize?.();
    const own = (name) => this.calls[layout.prefix + "_" + name];
    this.own = { prepare: own("prepare"), motion: own("motion"), batch: own("batch"), section: own("section"), message: own("message") };
    this.real = layout.precision === "single" ? Float32Array : Float64Array;
    let at = (this.calls.__heap_base.value + 15) & ~15;
    const room = (bytes) => {
      const place = at;
      at += (bytes + 15) & ~15;
      return place;
    };
    this.model = room(layout.model);
    this.given = room(8 * Math.max(1, layout.parameters));
    this.forces = room(8 * Math.max(1, layout.forces));
    this.more = room(8 * (layout.more ?? 0));
    this.start = at;
    this.fit(1);
  }

  /** Make room for the inputs, outputs and statuses of so many instants. */
  fit(count) {
    const size = this.real.BYTES_PER_ELEMENT;
    this.count = count;
    this.in = this.start;
    this.out = (this.in + size * this.layout.inputs * count + 15) & ~15;
    this.statusAt = (this.out + size * this.layout.outputs * count + 15) & ~15;
    const lacking = this.statusAt + 4 * count - this.calls.memory.buffer.byteLength;
    if (lacking > 0) this.calls.memory.grow(Math.ceil(lacking / 65536));
  }

  get inputs() {
    return new this.real(this.calls.memory.buffer, this.in, this.layout.inputs * this.count);
  }

  get outputs() {
    return new this.real(this.calls.memory.buffer, this.out, this.layout.outputs * this.count);
  }

  get statuses() {
    return new Int32Array(this.calls.memory.buffer, this.statusAt, this.count);
  }

  /** Take parameters, in the order of the C's struct, and begin anew. Returns a status, as all that follow do: 0 where all is well. */
  prepare(values) {
    new this.real(this.calls.memory.buffer, this.given, values.length).set(values);
    return this.own.prepare(this.model, this.given);
  }

  /** Put what the scene's motion prescribes at a time [s] into the inputs with a number. */
  motion(time, number = 0) {
    const place = this.in + this.real.BYTES_PER_ELEMENT * this.layout.inputs * number;
    if (this.layout.precision !== "single") return this.own.motion(this.model, time, place);
    return this.own.motion(this.model, Math.fround(time), time - Math.fround(time), place);
  }

  /** Evaluate the first instants, so many; the status of each is among the statuses. */
  evaluate(count = this.count) {
    return this.own.batch(this.model, count, this.in, this.out, this.statusAt);
  }

  /** The forces inside a link at a ratio xi/l, for the outputs with a number; null if there are none; `failed` is the status with the reason. */
  section(link, xi, number = 0) {
    const place = this.out + this.real.BYTES_PER_ELEMENT * this.layout.outputs * number;
    this.failed = this.own.section(this.model, place, link, xi, this.forces);
    return this.failed ? null : new this.real(this.calls.memory.buffer, this.forces, this.layout.forces);
  }

  /** What a status means. */
  message(status) {
    const bytes = new Uint8Array(this.calls.memory.buffer, this.own.message(status));
    return new TextDecoder().decode(bytes.subarray(0, bytes.indexOf(0)));
  }
}
