// Where along a link its forces are smallest and largest at an instant, exactly: in pieces of the link they are polynomials.

/** The law of a link in a live page. `sourceOf` tells which output an array of the page is. */
class Along {
  constructor(entry, told, engine, sourceOf) {
    Object.assign(this, { entry, told, engine, sourceOf });
    this.spreads = told.spreads.map((ends) => ends.map((source) => source - engine.layout.inputs));
    this.plain = entry.forces.filter((force) => !force.parts.length);
    const place = new Map(this.plain.map((force, k) => [force.name, k]));
    this.sources = [...new Set(this.plain.flatMap((force) => force.terms.map(([coefficient]) => sourceOf(coefficient))))];
    this.terms = this.plain.map((force) => [...new Set(force.terms.map(([coefficient]) => this.sources.indexOf(sourceOf(coefficient))))]);
    this.loadSources = entry.loads.map(({ name, ...members }) => Object.fromEntries(Object.entries(members).map(([member, number]) => [member, sourceOf(number)])));
    this.members = Object.keys(this.loadSources[0] ?? {});
    this.loads = this.loadSources.map((members) => ({ ...members }));
    this.values = new Float64Array(this.sources.length);
    this.scratch = this.plain.map(() => new Float64Array(told.degree + 1));
    this.tallies = entry.forces.map(() => new Float64Array(6).fill(NaN));
    this.asked = entry.forces.flatMap((force, k) => {
      const parts = (force.parts.length ? force.parts : [force.name]).map((name) => this.scratch[place.get(name)]);
      return force.open ? [] : [{ parts, tally: this.tallies[k] }];
    });
    this.needed = this.scratch.map((c) => this.asked.some((one) => one.parts.includes(c)));
    this.series = new Map();
  }

  /** Take the design that the engine is prepared for; `first` are the outputs of one of its instants. */
  prepare(length, first) {
    const { told, engine, entry } = this;
    this.length = length;
    const constants = this.spreads.flat().map((source) => [source, first[source]]);
    const marks = this.spreads.flatMap(([width, end]) => [first[end] - first[width], first[end]]).filter((u) => u > 0 && u < 1);
    const cuts = [...new Set([...told.breaks, ...marks])].sort((a, b) => a - b);
    const nodes = Array.from({ length: told.degree + 1 }, (_, j) => Math.cos((Math.PI * j) / told.degree));
    const unit = (source) => {
      const outputs = engine.outputs;
      outputs.fill(0);
      for (const [place, value] of constants) outputs[place] = value;
      outputs[source] = 1;
    };
    engine.fit(1);
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

  /** What each determined force is at an instant, of which `read` gives the outputs: smallest, where, largest, where, largest in size,
   *  where. The numbers hold until the next call. */
  reach(read) {
    const { values, loads, tallies } = this;
    for (let k = 0; k < values.length; k += 1) values[k] = read(this.sources[k]);
    for (let k = 0; k < loads.length; k += 1) for (const member of this.members) loads[k][member] = read(this.loadSources[k][member]);
    for (const tally of tallies) tally[0] = NaN;
    const stations = loads.map((load) => load.station).filter((u) => u > 0 && u < 1).sort((a, b) => a - b);
    for (const piece of this.pieces) {
      let low = piece.low;
      for (const u of stations) {
        if (u <= low || u >= piece.high) continue;
        this.look(piece, low, u, (low + u) / 2);
        low = u;
      }
      this.look(piece, low, piece.high, (low + piece.high) / 2);
    }
    // What acts at the very base is seen by the section there from its base side alone.
    if (loads.some((load) => load.station === 0)) this.look(this.pieces[0], 0, 0, -1);
    return tallies;
  }

  /** Look for smallest and largest values in a part of a piece; what acts beyond its `middle` is seen there. */
  look(piece, low, high, middle) {
    for (let k = 0; k < this.plain.length; k += 1) if (this.needed[k]) this.sum(k, piece, middle);
    const [a, b] = [(low - piece.middle) / piece.half, (high - piece.middle) / piece.half];
    for (const { parts, tally } of this.asked) {
      put(tally, sizeAt(parts, a), low);
      if (b <= a) continue;
      put(tally, sizeAt(parts, b), high);
      for (const v of zerosOf(parts.length > 1 ? squaredSlope(parts) : slopeOf(parts[0]), a, b)) put(tally, sizeAt(parts, v), piece.middle + piece.half * v);
    }
  }

  /** A force in a piece, with what acts at the stations that are seen. */
  sum(k, piece, middle) {
    const [force, c, rows] = [this.plain[k], this.scratch[k].fill(0), piece.rows[k]];
    for (const number of this.terms[k]) {
      const [row, value] = [rows[number], this.values[number]];
      for (let j = 0; j < c.length; j += 1) c[j] += value * row[j];
    }
    for (const load of this.loads) {
      if (!(middle < load.station)) continue;
      c[0] += load[force.acting];
      if (!force.arm) continue;
      const slope = force.arm * this.length * load[force.across];
      c[0] += slope * (load.station - piece.middle);
      c[1] -= slope * piece.half;
    }
  }
}

function sizeAt(parts, v) {
  if (parts.length === 1) return chebyshevAt(parts[0], v);
  let size = 0;
  for (const c of parts) size = Math.hypot(size, chebyshevAt(c, v));
  return size;
}

function put(tally, value, u) {
  const first = Number.isNaN(tally[0]);
  if (first || value < tally[0]) [tally[0], tally[1]] = [value, u];
  if (first || value > tally[2]) [tally[2], tally[3]] = [value, u];
  if (first || Math.abs(value) > Math.abs(tally[4])) [tally[4], tally[5]] = [value, u];
}

/** The slope of a sum of squares, halved. */
function squaredSlope(parts) {
  const found = new Float64Array(2 * parts[0].length - 2);
  for (const c of parts) addProduct(found, c, slopeOf(c));
  return found;
}
