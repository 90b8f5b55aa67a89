// Where along a link its forces are smallest and largest at an instant, exactly: in pieces of the link they are polynomials.

/** The law of a link in a live page. `sourceOf` gives the output that an array of the page is. */
class Along {
  constructor(entry, live, engine, sourceOf) {
    Object.assign(this, { entry, live, engine });
    this.degree = live.degree;
    this.many = live.degree + 1;
    const partsOf = (force) => (force.parts.length ? force.parts : [force.name]);
    const asked = entry.forces.filter((force) => !force.open).flatMap(partsOf);
    this.plain = entry.forces.filter((force) => asked.includes(force.name));
    const place = new Map(this.plain.map((force, k) => [force.name, k]));
    // Of all outputs it keeps its own, an instant after another.
    this.outputs = [];
    const own = (output) => {
      if (!this.outputs.includes(output)) this.outputs.push(output);
      return this.outputs.indexOf(output);
    };
    const kept = (number) => own(sourceOf(number));
    this.terms = this.plain.map((force) => [...new Set(force.terms.map(([coefficient]) => kept(coefficient)))]);
    this.spreads = live.spreads.map((ends) => ends.map((source) => own(source - engine.layout.inputs)));
    this.stations = entry.loads.map((load) => kept(load.station));
    this.acting = this.plain.map((force) => entry.loads.map((load) => kept(load[force.acting])));
    this.across = this.plain.map((force) => (force.arm ? entry.loads.map((load) => kept(load[force.across])) : null));
    this.rowsOf = this.plain.map((force) => force.terms.map(([coefficient, row, sign]) => [kept(coefficient), array(row), sign]));
    this.scratch = this.plain.map(() => new Float64Array(this.many));
    this.factor = new Float64Array(this.many);
    this.tallies = entry.forces.map(() => new Float64Array(6).fill(NaN));
    this.asked = entry.forces.flatMap((force, k) => {
      const parts = partsOf(force).map((name) => this.scratch[place.get(name)]);
      return force.open ? [] : [{ parts, tally: this.tallies[k], slope: new Float64Array(2 * this.many), known: new Float64Array(1) }];
    });
    this.series = new Map();
    this.rowOf = new Map();
    this.peaks = new Set();
    this.pieces = [];
  }

  /** Have room for the outputs of so many instants. */
  fit(count) {
    if (this.held?.length !== count * this.outputs.length) this.held = new Float64Array(count * this.outputs.length);
  }

  /** Keep what it needs of the outputs of some instants, the first of which has a number; each has so many. */
  keep(outputs, many, from, count) {
    const { held, outputs: own } = this;
    let place = from * own.length;
    for (let i = 0; i < count; i += 1) for (let k = 0; k < own.length; k += 1) held[place++] = outputs[i * many + own[k]];
  }

  /** Take the design that the engine is prepared for, of which all instants are kept. */
  prepare(length) {
    const { live, engine, entry, held, degree } = this;
    this.length = length;
    for (const { known } of this.asked) known[0] = -Infinity;
    const constants = this.spreads.flat().map((own) => [this.outputs[own], held[own]]);
    const marks = this.spreads.flatMap(([width, end]) => [held[end] - held[width], held[end]]).filter((u) => u > 0 && u < 1);
    let changed = this.cut([...new Set([...live.breaks, ...marks])].sort((a, b) => a - b));
    engine.fit(1);
    const outputs = engine.outputs;
    const columns = this.plain.map((force) => contents.live.forces.indexOf(force.name));
    const values = this.plain.map(() => new Float64Array(this.many));
    const { places } = interpolation(degree);
    for (const source of new Set(this.terms.flat())) {
      outputs.fill(0);
      for (const [output, value] of constants) outputs[output] = value;
      outputs[this.outputs[source]] = 1;
      const changing = this.plain.map((_, k) => k).filter((k) => this.terms[k].includes(source));
      for (const piece of this.pieces) {
        for (let j = 0; j <= degree; j += 1) {
          const forces = this.forcesAt(Math.min(1, piece.low + (piece.high - piece.low) * places[j]));
          for (const k of changing) values[k][j] = forces[columns[k]];
        }
        for (const k of changing) if (ordinatesInto(piece.rows[k][this.terms[k].indexOf(source)], values[k])) changed = true;
      }
      if (changed) this.fill(array(entry.xi), source, changing, columns);
    }
  }

  /** Have pieces between cuts; those that there were before are kept, with all that is known of them. Returns whether any is new. */
  cut(cuts) {
    if (cuts.length === this.pieces.length + 1 && this.pieces.every(({ low, high }, k) => low === cuts[k] && high === cuts[k + 1])) return false;
    const rows = () => this.terms.map((own) => own.map(() => new Float64Array(this.many)));
    this.pieces = cuts.slice(1).map((high, k) => ({ low: cuts[k], high, rows: rows() }));
    return true;
  }

  /** Put a function along the link into the rows of the page. */
  fill(xi, source, changing, columns) {
    for (let j = 0; j < xi.length; j += 1) {
      const piece = this.pieces.find(({ low, high }) => xi[j] > low && xi[j] < high);
      const forces = piece ? null : this.forcesAt(xi[j]);
      for (const k of changing) {
        const value = piece ? valueAt(piece.rows[k][this.terms[k].indexOf(source)], this.degree, (xi[j] - piece.low) / (piece.high - piece.low)) : forces[columns[k]];
        for (const [own, row, sign] of this.rowsOf[k]) if (own === source) row[j] = value / sign;
      }
    }
  }

  forcesAt(u) {
    const found = this.engine.section(this.live.number, u);
    if (!found) throw new Error(this.engine.message(this.engine.failed));
    return found;
  }

  /** Report of every instant, with its number, what each determined force is there: smallest, where, largest, where, largest in size,
   *  where. The numbers hold until the next instant. Unless `whole`, what is no larger in size than what was found for this design is
   *  left out: the peak of the cycle is the same. */
  reachAll(count, whole, put) {
    // Where the peaks were in the design before, those of this one are near: then little is beyond what is known.
    if (!whole) for (const instant of this.peaks) if (instant < count) this.reach(instant, false);
    this.peaks.clear();
    for (let i = 0; i < count; i += 1) put(this.reach(i, whole), i);
  }

  reach(instant, whole) {
    const { tallies, stations, held } = this;
    const place = instant * this.outputs.length;
    for (let k = 0; k < tallies.length; k += 1) tallies[k][0] = NaN;
    if (!stations.length) {
      for (const piece of this.pieces) this.look(piece, piece.low, piece.high, place, whole);
      return tallies;
    }
    const cuts = stations.map((own) => held[place + own]);
    const inner = cuts.filter((u) => u > 0 && u < 1).sort((a, b) => a - b);
    for (const piece of this.pieces) {
      let low = piece.low;
      for (const u of inner) {
        if (u <= low || u >= piece.high) continue;
        this.look(piece, low, u, place, whole);
        low = u;
      }
      this.look(piece, low, piece.high, place, whole);
    }
    return tallies;
  }

  /** Look for smallest and largest values in a part of a piece; what acts beyond its `low` end is included there. */
  look(piece, low, high, place, whole) {
    const { degree, scratch } = this;
    const edge = edgeAt(this.entry, low);
    for (let k = 0; k < this.plain.length; k += 1) this.sum(k, piece, edge, place);
    if (low > piece.low || high < piece.high) {
      const [from, to] = [low, high].map((u) => (u - piece.low) / (piece.high - piece.low));
      for (const c of scratch) cutTo(c, degree, from, to);
    }
    for (const { parts, tally, slope, known } of this.asked) {
      const bound = whole ? Infinity : boundOf(parts);
      if (high > low && bound < (1 - ROUNDED) * known[0]) continue;
      put(tally, known, sizeAt(parts, 0), low);
      if (high === low) continue;
      put(tally, known, sizeAt(parts, 1), high);
      if (bound <= (1 + ROUNDED) * Math.abs(tally[4])) continue;
      if (parts.length > 1) squaredSlope(parts, slope, this.factor);
      else slopeInto(slope, parts[0], degree);
      const zeros = zerosOf(slope, parts.length > 1 ? 2 * degree - 1 : degree - 1);
      for (let z = 0; z < zeros.count; z += 1) put(tally, known, sizeAt(parts, zeros.at[z]), low + (high - low) * zeros.at[z]);
    }
  }

  /** A force in a piece, with what acts at the stations beyond an edge. */
  sum(k, piece, edge, place) {
    const { degree, many, held, stations } = this;
    const c = this.scratch[k];
    const rows = piece.rows[k];
    const terms = this.terms[k];
    for (let j = 0; j < many; j += 1) c[j] = 0;
    for (let n = 0; n < terms.length; n += 1) {
      const row = rows[n];
      const value = held[place + terms[n]];
      for (let j = 0; j < many; j += 1) c[j] += value * row[j];
    }
    if (!stations.length) return;
    const acting = this.acting[k];
    const across = this.across[k];
    for (let l = 0; l < stations.length; l += 1) {
      const station = held[place + stations[l]];
      if (!(edge < station)) continue;
      const slope = across ? this.plain[k].arm * this.length * held[place + across[l]] : 0;
      const first = held[place + acting[l]] + slope * (station - piece.low);
      for (let j = 0; j < many; j += 1) c[j] += first - (slope * (piece.high - piece.low) * j) / degree;
    }
  }
}

/** A force at a place; of several the size, which is nothing where it is no more than rounding. */
function sizeAt(parts, x) {
  if (parts.length === 1) return valueAt(parts[0], parts[0].length - 1, x);
  let sum = 0;
  let scale = 0;
  for (let p = 0; p < parts.length; p += 1) {
    const c = parts[p];
    sum += valueAt(c, c.length - 1, x) ** 2;
    scale += largestSize(c);
  }
  const size = Math.sqrt(sum);
  return size > VANISHING * scale ? size : 0;
}

function largestSize(c) {
  let most = 0;
  for (let k = 0; k < c.length; k += 1) most = Math.max(most, Math.abs(c[k]));
  return most;
}

/** What a force is nowhere from 0 to 1 beyond in size: no polynomial is beyond its ordinates of Bernstein. */
function boundOf(parts) {
  let sum = 0;
  for (const c of parts) sum += largestSize(c) ** 2;
  return Math.sqrt(sum);
}

const ROUNDED = 1e-12; // Over a value: more than rounding can hide.

const VANISHING = 2e-13; // Over the ordinates of a size: what is smaller at a place is the rounding of nothing.

function put(tally, known, value, u) {
  const first = Number.isNaN(tally[0]);
  if (first || value < tally[0]) {
    tally[0] = value;
    tally[1] = u;
  }
  if (first || value > tally[2]) {
    tally[2] = value;
    tally[3] = u;
  }
  if (first || Math.abs(value) > Math.abs(tally[4])) {
    tally[4] = value;
    tally[5] = u;
    if (Math.abs(value) > known[0]) known[0] = Math.abs(value);
  }
}

/** Half the slope of a sum of squares, into `found`. `slope` has room for the slope of a part. */
function squaredSlope(parts, found, slope) {
  const n = parts[0].length - 1;
  found.fill(0);
  for (const c of parts) {
    slopeInto(slope, c, n);
    addProduct(found, c, n, slope, n - 1);
  }
}
