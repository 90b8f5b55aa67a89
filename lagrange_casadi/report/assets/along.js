// Where along a link its forces are smallest and largest at an instant, exactly: in pieces of the link they are polynomials.

/** The law of a link in a live page. `sourceOf` tells which output an array of the page is. */
class Along {
  constructor(entry, told, engine, sourceOf) {
    Object.assign(this, { entry, told, engine, sourceOf });
    this.many = told.degree + 1;
    this.spreads = told.spreads.map((ends) => ends.map((source) => source - engine.layout.inputs));
    this.plain = entry.forces.filter((force) => !force.parts.length);
    const place = new Map(this.plain.map((force, k) => [force.name, k]));
    this.sources = [...new Set(this.plain.flatMap((force) => force.terms.map(([coefficient]) => sourceOf(coefficient))))];
    this.terms = this.plain.map((force) => [...new Set(force.terms.map(([coefficient]) => this.sources.indexOf(sourceOf(coefficient))))]);
    this.stations = entry.loads.map((load) => sourceOf(load.station));
    this.acting = this.plain.map((force) => entry.loads.map((load) => sourceOf(load[force.acting])));
    this.across = this.plain.map((force) => (force.arm ? entry.loads.map((load) => sourceOf(load[force.across])) : null));
    this.scratch = this.plain.map(() => new Float64Array(this.many));
    this.factor = new Float64Array(this.many);
    this.tallies = entry.forces.map(() => new Float64Array(6).fill(NaN));
    this.asked = entry.forces.flatMap((force, k) => {
      const parts = (force.parts.length ? force.parts : [force.name]).map((name) => this.scratch[place.get(name)]);
      return force.open ? [] : [{ parts, tally: this.tallies[k], slope: new Float64Array(2 * this.many), known: new Float64Array(2) }];
    });
    this.needed = this.scratch.map((c) => this.asked.some((one) => one.parts.includes(c)));
    this.series = new Map();
  }

  /** Take the design that the engine is prepared for; `first` are the outputs of one of its instants. */
  prepare(length, first) {
    const { told, engine, entry } = this;
    this.length = length;
    for (const { known } of this.asked) [known[0], known[1]] = [Infinity, -Infinity];
    const constants = this.spreads.flat().map((source) => [source, first[source]]);
    const marks = this.spreads.flatMap(([width, end]) => [first[end] - first[width], first[end]]).filter((u) => u > 0 && u < 1);
    const cuts = [...new Set([...told.breaks, ...marks])].sort((a, b) => a - b);
    const nodes = Array.from({ length: this.many }, (_, j) => Math.cos((Math.PI * j) / told.degree));
    engine.fit(1);
    const outputs = engine.outputs;
    const unit = (source) => {
      outputs.fill(0);
      for (const [place, value] of constants) outputs[place] = value;
      outputs[source] = 1;
    };
    this.pieces = cuts.slice(1).map((high, k) => ({ low: cuts[k], high, middle: (cuts[k] + high) / 2, half: (high - cuts[k]) / 2 }));
    for (const piece of this.pieces) piece.rows = this.plain.map(() => []);
    const names = contents.live.forces;
    const columns = this.plain.map((force) => names.indexOf(force.name));
    const xi = array(entry.xi);
    this.sources.forEach((source, number) => {
      unit(source);
      const at = (u) => {
        const forces = this.forcesAt(u);
        return columns.map((column) => forces[column]);
      };
      for (const piece of this.pieces) {
        const values = nodes.map((v) => at(Math.max(0, Math.min(1, piece.middle + piece.half * v))));
        this.plain.forEach((_, k) => (piece.rows[k][number] = chebyshevOf(values.map((row) => row[k]))));
      }
      const rows = this.plain.flatMap((force, k) => force.terms.filter(([coefficient]) => this.sourceOf(coefficient) === source).map(([, row, sign]) => [array(row), sign, columns[k]]));
      if (!rows.length) return;
      for (let j = 0; j < xi.length; j += 1) {
        const forces = this.forcesAt(xi[j]);
        for (const [row, sign, column] of rows) row[j] = forces[column] / sign;
      }
    });
  }

  forcesAt(u) {
    const found = this.engine.section(this.told.number, u);
    if (!found) throw new Error(this.engine.message(this.engine.failed));
    return found;
  }

  /** What each determined force is at the instant whose outputs begin at a place of `outputs`: smallest, where, largest, where,
   *  largest in size, where. The numbers hold until the next call. Unless `whole`, what cannot be beyond all that was found since the
   *  design was taken is not looked for within pieces: the ends of the cycle are the same. */
  reach(outputs, place, whole) {
    const { tallies, stations } = this;
    for (const tally of tallies) tally[0] = NaN;
    const cuts = stations.length ? stations.map((source) => outputs[place + source]) : stations;
    const inner = cuts.length ? cuts.filter((u) => u > 0 && u < 1).sort((a, b) => a - b) : cuts;
    for (const piece of this.pieces) {
      let low = piece.low;
      for (const u of inner) {
        if (u <= low || u >= piece.high) continue;
        this.look(piece, low, u, (low + u) / 2, outputs, place, whole);
        low = u;
      }
      this.look(piece, low, piece.high, (low + piece.high) / 2, outputs, place, whole);
    }
    // What acts at the very base is seen by the section there from its base side alone.
    if (cuts.includes(0)) this.look(this.pieces[0], 0, 0, -1, outputs, place, whole);
    return tallies;
  }

  /** Look for smallest and largest values in a part of a piece; what acts beyond its `middle` is seen there. */
  look(piece, low, high, middle, outputs, place, whole) {
    for (let k = 0; k < this.plain.length; k += 1) if (this.needed[k]) this.sum(k, piece, middle, outputs, place);
    const [a, b] = [(low - piece.middle) / piece.half, (high - piece.middle) / piece.half];
    for (const { parts, tally, slope, known } of this.asked) {
      put(tally, known, sizeAt(parts, a), low);
      if (b <= a) continue;
      put(tally, known, sizeAt(parts, b), high);
      if (!whole && isWithin(parts, known)) continue;
      const count = parts.length > 1 ? squaredSlope(parts, slope, this.factor) : slopeInto(slope, parts[0], this.many);
      const zeros = zerosOf(slope, count, a, b);
      for (let z = 0; z < zeros.count; z += 1) put(tally, known, sizeAt(parts, zeros.at[z]), piece.middle + piece.half * zeros.at[z]);
    }
  }

  /** A force in a piece, with what acts at the stations that are seen. */
  sum(k, piece, middle, outputs, place) {
    const [c, rows, { many }] = [this.scratch[k].fill(0), piece.rows[k], this];
    for (const number of this.terms[k]) {
      const [row, value] = [rows[number], outputs[place + this.sources[number]]];
      for (let j = 0; j < many; j += 1) c[j] += value * row[j];
    }
    const [stations, acting, across] = [this.stations, this.acting[k], this.across[k]];
    for (let l = 0; l < stations.length; l += 1) {
      const station = outputs[place + stations[l]];
      if (!(middle < station)) continue;
      c[0] += outputs[place + acting[l]];
      if (!across) continue;
      const slope = this.plain[k].arm * this.length * outputs[place + across[l]];
      c[0] += slope * (station - piece.middle);
      c[1] -= slope * piece.half;
    }
  }
}

function sizeAt(parts, v) {
  if (parts.length === 1) return chebyshevAt(parts[0], v, parts[0].length);
  let size = 0;
  for (const c of parts) size = Math.hypot(size, chebyshevAt(c, v, c.length));
  return size;
}

/** Whether a sum, or the size of several, can nowhere on -1 to 1 be beyond what is known: no polynomial of Chebyshev's is above 1. */
function isWithin(parts, known) {
  let [low, high] = [0, 0];
  for (const c of parts) {
    let reach = 0;
    for (let k = 1; k < c.length; k += 1) reach += Math.abs(c[k]);
    reach += ROUNDED * (Math.abs(c[0]) + reach);
    if (parts.length === 1) [low, high] = [c[0] - reach, c[0] + reach];
    else [low, high] = [Math.hypot(low, Math.max(0, Math.abs(c[0]) - reach)), Math.hypot(high, Math.abs(c[0]) + reach)];
  }
  return high <= known[1] && low >= known[0];
}

const ROUNDED = 1e-12; // Over a value: more than rounding can hide.

function put(tally, known, value, u) {
  const first = Number.isNaN(tally[0]);
  if (first || value < tally[0]) {
    tally[0] = value;
    tally[1] = u;
    if (value < known[0]) known[0] = value;
  }
  if (first || value > tally[2]) {
    tally[2] = value;
    tally[3] = u;
    if (value > known[1]) known[1] = value;
  }
  if (first || Math.abs(value) > Math.abs(tally[4])) {
    tally[4] = value;
    tally[5] = u;
  }
}

/** Half the slope of a sum of squares, into `found`; returns how many coefficients it has. `slope` has room for the slope of a part. */
function squaredSlope(parts, found, slope) {
  const many = parts[0].length;
  found.fill(0);
  for (const c of parts) addProduct(found, c, many, slope, slopeInto(slope, c, many));
  return 2 * many - 2;
}
