// The engine in the page: for other parameters it evaluates the whole cycle, and puts what it finds in the place of what is shown.

const BLOCK = 128; // Instants that are evaluated at once: so many that their numbers stay near the processor.

class Alive {
  constructor(instance) {
    const live = contents.live;
    this.live = live;
    this.engine = new Engine(instance, live.layout);
    this.values = Float64Array.from(contents.parameters, (one) => one.value);
    this.file = { values: this.values.slice(), defaults: live.defaults, rows: structuredClone(contents.rows), t: instants.t.slice() };
    this.why = null;
    this.turn = 0; // Of the links whose forces are looked at.
    this.known = this.file.values;
    this.postures = new Postures(this);
    this.read();
    this.carries = true;
    this.file.numbers = this.numbers(this.values);
    const rowsTold = new Set([...this.targets.map((target) => target.row), ...this.curves.flatMap((curve) => [...curve.rowOf.values()])]);
    this.untold = contents.rows.filter((row) => !row.open && !rowsTold.has(row));
    const ends = this.curves.flatMap((curve) => [...curve.series.values()].flat());
    this.shown = [...this.targets.map((target) => target.array), ...ends, ...this.bars.flat(), ...this.unknown];
    const rows = contents.sections.flatMap((entry) => entry.forces.flatMap((force) => force.terms.map(([, row]) => array(row))));
    this.kept = [...new Set([instants.t, ...(over ? [array(over.values)] : []), ...this.shown, ...rows])].map((values) => [values, values.slice()]);
  }

  /** Find what each array of the page is made of. */
  read() {
    const { live } = this;
    const of = new Map(live.of);
    const single = (number) => of.get(number)[0] - live.layout.inputs;
    const named = new Map(contents.series.map((one) => [one.values, one.name]));
    const poses = contents.bodies.flatMap((body) => body.pose.map((number, k) => [number, [live.poses[body.name][k]]]));
    const read = [...live.of, ...poses.filter(([number, [source]]) => source >= 0 && !of.has(number))];
    this.targets = read.map(([number, sources]) => ({ array: array(number), sources, row: rowByName.get(named.get(number)) }));
    this.column = new Float64Array(BLOCK);
    this.bars = contents.bodies.filter(({ name }) => this.lacksAxes(name)).map((body) => body.pose.map(array));
    // What the module does not compute, as residuals, is of the file's design alone.
    this.unknown = contents.series.filter((one) => one.group !== "section" && !of.has(one.values)).map((one) => array(one.values));
    // What equilibrium leaves open is not in the module.
    this.curves = contents.sections.filter((entry) => live.links[entry.link] && knownForces(sectionByLink.get(entry.link)).length).map((entry) => {
      const curve = new Along(entry, live.links[entry.link], this.engine, single);
      entry.forces.forEach((force, k) => {
        const one = seriesByName.get(`section:${entry.link}:${force.name}`);
        const row = rowByName.get(`section:${entry.link}:${force.name}`);
        if (one) curve.series.set(k, [array(one.values), array(one.places)]);
        if (row && !row.open) curve.rowOf.set(k, row);
      });
      return curve;
    });
    this.position = null;
    if (live.shown) {
      this.position = new Int32Array(live.timing.count).fill(-1);
      live.shown.forEach((instant, k) => (this.position[instant] = k));
    }
  }

  /** Whether the engine gives no more of a body's axes than its x. */
  lacksAxes(name) {
    return this.live.poses[name].slice(6).some((source) => source < 0);
  }

  /** Whether the design is the file's own. */
  get own() {
    return this.values.every((value, k) => value === this.file.values[k]);
  }

  /** Show a design. What it is without, as where it cannot be assembled, is then said by `why`. Unless `whole`, series of what is
   *  largest along a link, rows but for their peaks, and these of every other link, are left as they are there, which is quicker. */
  show(values, whole = true) {
    whole ||= Boolean(this.why);
    this.values = Float64Array.from(values);
    contents.parameters.forEach((one, k) => (one.value = this.values[k]));
    this.why = this.stood = null;
    if (this.own) {
      for (const [array, before] of this.kept) array.set(before);
      contents.rows.forEach((row, k) => Object.assign(row, structuredClone(this.file.rows[k])));
      this.engine.prepare(this.values);
      this.place();
      for (const curve of this.curves) curve.pieces = []; // The page's rows are those of another design now.
      this.known = this.values;
      return;
    }
    try {
      this.evaluate(whole);
      this.known = this.values;
    } catch (error) {
      if (!(error instanceof NoResult)) throw error;
      this.why = error.message;
      for (const values of this.shown) values.fill(NaN);
      for (const row of contents.rows) if (!row.open) lose(row);
    }
  }

  evaluate(whole) {
    const { engine, live } = this;
    this.check(engine.prepare(this.values), null);
    const numbers = this.place();
    const times = this.times(numbers[0], numbers[1]);
    if (live.loops) this.close(times[0]);
    const weights = weightsOf(times);
    const tallies = new Map();
    const tallyOf = (row, along) => row && !row.open && (tallies.get(row) ?? tallies.set(row, new Tally(along)).get(row));
    for (const target of this.targets) target.tally = tallyOf(target.row, false);
    for (const curve of this.curves) curve.fit(times.length);
    this.turns = live.wrapped.map(() => null);
    for (let from = 0; from < times.length; from += BLOCK) this.block(times, weights, from, Math.min(BLOCK, times.length - from));
    this.put(instants.t, times, 0, times.length);
    if (over) this.put(array(over.values), this.coordinates, 0, times.length);
    // Unless it is the whole that is shown links take turns: the peaks of the others are those of the design before.
    this.turn += 1;
    this.curves.forEach((curve, k) => this.along(curve, times.length, whole, (row) => (whole || (k + this.turn) % 2 === 0) && tallyOf(row, true)));
    for (const [row, tally] of tallies) Object.assign(row, tally.described(times, this.coordinates, whole));
    for (const bar of this.bars) {
      for (let i = 0; i < bar[0].length; i += 1) {
        const pose = bar.map((column) => column[i]);
        complete(pose);
        bar.forEach((column, k) => (column[i] = pose[k]));
      }
    }
    for (const values of this.unknown) values.fill(NaN);
    for (const row of this.untold) lose(row);
  }

  /** Put values of instants, the first of which has a number, where they are shown. */
  put(into, values, from, count) {
    const { position } = this;
    if (!position) {
      into.set(values.subarray(0, count), from);
      return;
    }
    for (let i = 0; i < count; i += 1) if (position[from + i] >= 0) into[position[from + i]] = values[i];
  }

  block(times, weights, from, count) {
    const { engine, live, column } = this;
    engine.fit(count);
    for (let i = 0; i < count; i += 1) this.check(engine.motion(times[from + i], i), times[from + i]);
    if (engine.evaluate(count)) {
      const i = engine.statuses.findIndex(Boolean);
      this.check(engine.statuses[i], times[from + i]);
    }
    const { inputs: given, outputs: many } = live.layout;
    const [inputs, outputs] = [engine.inputs, engine.outputs];
    live.wrapped.forEach((output, k) => (this.turns[k] = unwrap(outputs, many, output, count, this.turns[k])));
    for (const { array: into, sources, tally } of this.targets) {
      const size = sources.length > 1;
      if (size) column.fill(0);
      for (const source of sources) {
        const [view, stride, start] = source < given ? [inputs, given, source] : [outputs, many, source - given];
        for (let i = 0; i < count; i += 1) column[i] = size ? column[i] + view[i * stride + start] ** 2 : view[i * stride + start];
      }
      if (size) for (let i = 0; i < count; i += 1) column[i] = Math.sqrt(column[i]);
      this.put(into, column, from, count);
      if (tally) tally.take(column, from, count, weights);
    }
    for (const curve of this.curves) curve.keep(outputs, many, from, count);
  }

  along(curve, count, whole, tallyOf) {
    const { position } = this;
    curve.prepare(this.lengths[curve.entry.link]);
    const rows = curve.entry.forces.map((_, k) => [k, tallyOf(curve.rowOf.get(k)), whole && curve.series.get(k)]).filter((row) => row[1] || row[2]);
    if (rows.length) curve.reachAll(count, whole, (found, i) => {
      const place = position ? position[i] : i;
      for (const [k, tally, series] of rows) {
        const ends = found[k];
        if (Number.isNaN(ends[0])) continue;
        if (series && place >= 0) {
          series[0][place] = ends[4];
          series[1][place] = ends[5];
        }
        if (tally) tally.reach(ends, i);
      }
    });
    for (const [, tally] of rows) if (tally) curve.peaks.add(tally.most[1]);
  }

  /** The times of the instants: equal steps, or when the drive's coordinate takes equal steps. */
  times(start, stop) {
    const { count, joint } = this.live.timing;
    if (!(Number.isFinite(start) && Number.isFinite(stop)) || (joint ? start === stop : stop < start)) throw new NoResult("there are no instants between the ends that these parameters give");
    const even = Float64Array.from({ length: count }, (_, i) => evenly(start, stop, count)(i));
    this.coordinates = joint ? even : null;
    if (!joint) return even;
    const found = new Float64Array(count);
    const scale = Math.max(Math.abs(start), Math.abs(stop));
    let t = this.file.t[0];
    for (let i = 0; i < count; i += 1) {
      const [best, least] = this.meet(even[i], t);
      if (!(least <= 1e-13 * scale) || (i > 0 && !(best > found[i - 1]))) throw new NoResult(`the motion of ${joint} does not cover the range from ${format(start)} to ${format(stop)}`);
      found[i] = best;
      t = best + (i + 1 < count ? (even[i + 1] - even[i]) / this.drive(best)[1] : 0);
    }
    return found;
  }

  /** The coordinate of the drive that takes equal steps, and its rate, at a time. */
  drive(t) {
    const { engine, live } = this;
    const { coordinate } = live.timing;
    engine.fit(1);
    this.check(engine.motion(t), t);
    return [engine.inputs[coordinate], engine.inputs[coordinate + 1]];
  }

  /** The time at which that coordinate has a value, sought from a time; and how far it is off there. */
  meet(value, from) {
    let [t, best, least] = [from, from, Infinity];
    for (let k = 0; k < 60; k += 1) {
      const [d, rate] = this.drive(t);
      const miss = Math.abs(d - value);
      if (miss < least) [best, least] = [t, miss];
      else if (k > 0) break;
      if (miss === 0) break;
      t -= (d - value) / rate;
    }
    return [best, least];
  }

  /** Have iterated loops begin where they stand in this design: from that of the file in steps, the fewer the better. */
  close(time) {
    const { engine, file } = this;
    const closes = (values, from) => {
      const status = engine.prepare(values);
      if (status) return status;
      if (from) this.loops.set(from);
      engine.fit(1);
      return engine.motion(time) || engine.evaluate(1);
    };
    let status = closes(this.values, null);
    for (let many = 4; status && many <= 64; many *= 4) {
      status = closes(file.values, null);
      for (let k = 1; k <= many && !status; k += 1) {
        const before = this.loops.slice();
        status = closes(this.values.map((value, n) => file.values[n] + (k / many) * (value - file.values[n])), before);
      }
    }
    const found = this.loops.slice();
    this.check(status, time);
    this.check(engine.prepare(this.values), null);
    this.loops.set(found);
  }

  numbersNow() {
    const { engine, live } = this;
    engine.calls.live_numbers(engine.given, engine.more);
    return new Float64Array(engine.calls.memory.buffer, engine.more, live.numbers).slice();
  }

  /** The ends of the instants, lengths, places and axes of a design. */
  numbers(values) {
    this.engine.prepare(values);
    return this.numbersNow();
  }

  /** Prepare for a design at an instant that is shown; returns the time, null where there is no such design. */
  prepareAt(values, instant) {
    const { engine, live } = this;
    const { count, joint } = live.timing;
    if (engine.prepare(values)) return null;
    const [start, stop] = this.numbersNow();
    const value = evenly(start, stop, count)(live.shown ? live.shown[instant] : instant);
    engine.fit(1);
    try {
      const time = joint ? this.meet(value, instants.t[instant])[0] : value;
      return Number.isFinite(time) && !engine.motion(time) ? time : null;
    } catch (error) {
      if (!(error instanceof NoResult)) throw error;
      return null;
    }
  }

  /** Have the parts of a design without a result stand at an instant as it leaves them; returns the gaps, null where that is not known. */
  stand(instant) {
    if (this.stood?.instant !== instant) {
      const near = this.postures.near(instant);
      const posture = near && this.postures.find(this.values, instant, near);
      if (posture) this.pose(posture);
      this.stood = { instant, posture, gaps: posture && this.postures.gapsOf(posture) };
    }
    return this.stood.gaps;
  }

  /** Put a posture into the poses of its instant. */
  pose(posture) {
    for (const [name, body] of bodies) {
      const [origin, x, y, z] = this.postures.frameOf(posture, name);
      const numbers = contents.space ? [...origin, ...x, ...y, ...z] : [...origin.slice(0, 2), Math.atan2(x[1], x[0])];
      if (this.lacksAxes(name)) complete(numbers);
      body.pose.forEach((column, k) => (column[posture.instant] = numbers[k]));
    }
  }

  /** The coordinates of iterated loops, in the engine's memory. */
  get loops() {
    return new Float64Array(this.engine.calls.memory.buffer, this.engine.model + this.live.loops[0], this.live.loops[1]);
  }

  /** Evaluate lengths, places and axes, and put them into the picture's parts; returns all numbers of the design. */
  place() {
    const { live } = this;
    const numbers = this.numbersNow();
    const at = (places) => places.map((place) => (place < 0 ? 0 : numbers[place]));
    const { picture } = live;
    this.lengths = {};
    contents.joints.forEach((joint, k) => {
      const own = picture.joints[k];
      joint.parent.at = at(own.parent);
      joint.child.at = at(own.child);
      if (own.axes) joint.axes = own.axes.map(at);
      if (own.turned) joint.second = own.turned.map((row) => dot(at(row), joint.axes[1]));
    });
    contents.loads.forEach((load, k) => {
      load.spots.forEach((spot, i) => (spot.at = at(picture.loads[k][i])));
      [load.closed] = at([picture.closed[k]]);
    });
    this.carries = picture.carried.every((place) => numbers[place] === this.file.numbers[place]);
    contents.paths.forEach((path, k) => (path.at = at(picture.paths[k])));
    const spots = [
      ...spotsNow(),
      ...picture.rollers.map((roller) => ({ body: roller.body, at: at(roller.at), radius: numbers[roller.radius] })),
    ];
    for (const body of contents.bodies) {
      const own = picture.bodies[body.name];
      const length = own.length < 0 ? null : numbers[own.length];
      const outlines = own.outlines.map((outline) => outline.map(at).filter((corner) => corner.every(Number.isFinite)));
      const shape = shapeOf(body.kind, length, own.centre && at(own.centre), spots.filter((spot) => spot.body === body.name), outlines);
      for (const one of [body, bodies.get(body.name)]) Object.assign(one, shape, { mass: numbers[own.mass] });
      this.lengths[body.name] = length;
      if (sectionByLink.has(body.name)) sectionByLink.get(body.name).length = length;
    }
    return numbers;
  }

  check(status, t) {
    if (status) throw new NoResult(`${this.engine.message(status)}${t === null ? "" : `, at t = ${shown(t, "s")}`}`);
  }
}

/** The values of equal steps between two ends, by their numbers. */
const evenly = (start, stop, count) => (i) => (i === count - 1 ? stop : start + i * ((stop - start) / (count - 1)));

/** Why a design has no numbers. */
class NoResult extends Error {}

/** What a quantity is over all instants; one that is `along` a link has a place there, and no mean. */
class Tally {
  constructor(along) {
    Object.assign(this, { along, low: [Infinity], high: [-Infinity], most: [0, 0, null], sum: 0, squares: 0 });
  }

  /** Take the values of some instants, the first of which has a number. */
  take(values, from, count, weights) {
    let [low, high, most, lowAt, highAt, mostAt] = [this.low[0], this.high[0], Math.abs(this.most[0]), -1, -1, -1];
    for (let i = 0; i < count; i += 1) {
      const [value, weight] = [values[i], weights[from + i]];
      if (value < low) [low, lowAt] = [value, i];
      if (value > high) [high, highAt] = [value, i];
      if (Math.abs(value) > most) [most, mostAt] = [Math.abs(value), i];
      this.sum += weight * value;
      this.squares += weight * value * value;
    }
    if (lowAt >= 0) this.low = [low, from + lowAt, null];
    if (highAt >= 0) this.high = [high, from + highAt, null];
    if (mostAt >= 0) this.most = [values[mostAt], from + mostAt, null];
  }

  reach(ends, instant) {
    if (ends[0] < this.low[0]) this.low = [ends[0], instant, ends[1]];
    if (ends[2] > this.high[0]) this.high = [ends[2], instant, ends[3]];
    if (this.most[2] === null || Math.abs(ends[4]) > Math.abs(this.most[0])) this.most = [ends[4], instant, ends[5]];
  }

  /** What a row says; of what is along a link its peak alone, unless it was looked at as a `whole`. */
  described(times, coordinates, whole) {
    const mark = ([value, instant, xi]) => ({ value, t: times[instant], xi, over: coordinates ? coordinates[instant] : null });
    const peak = { peak: mark(this.most), error: null };
    if (this.along && !whole) return peak;
    const ends = { ...peak, smallest: mark(this.low), largest: mark(this.high) };
    return this.along ? ends : { ...ends, mean: this.sum, rms: Math.sqrt(this.squares) };
  }
}

/** A row of which nothing is known. */
function lose(row) {
  for (const end of ["peak", "smallest", "largest"]) row[end] = { value: NaN, t: NaN, xi: row[end].xi === null ? null : NaN, over: NaN };
  Object.assign(row, { error: null, mean: row.mean === null ? null : NaN, rms: row.rms === null ? null : NaN });
}

/** The part of the time that each instant stands for, by trapezia. */
function weightsOf(t) {
  const found = new Float64Array(t.length);
  for (let i = 1; i < t.length; i += 1) {
    found[i - 1] += t[i] - t[i - 1];
    found[i] += t[i] - t[i - 1];
  }
  const sum = found.reduce((all, weight) => all + weight, 0);
  return sum ? found.map((weight) => weight / sum) : found.fill(1 / t.length);
}

/** Let an angle go on where it jumps by a turn; `before` is where it was. Returns where it is at last. */
function unwrap(view, stride, start, count, before) {
  let last = before;
  for (let i = 0; i < count; i += 1) {
    const at = i * stride + start;
    if (last !== null) view[at] += 2 * Math.PI * Math.round((last - view[at]) / (2 * Math.PI));
    last = view[at];
  }
  return last;
}

/** Of a pose whose own x axis alone is known: two axes that go with it. */
function complete(pose) {
  const [y, z] = acrossOf(pose.slice(3, 6)).map((axis) => times(axis, -1));
  for (let k = 0; k < 3; k += 1) [pose[6 + k], pose[9 + k]] = [y[k], z[k]];
}
