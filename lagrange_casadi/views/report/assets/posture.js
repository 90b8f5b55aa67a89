// Postures of a live page, whether loops close or not, by the equations of engine/placement.py: loops close that can, and of the others the
// sum of squares of their equations is least.

const CLOSED = 1e-9; // Of the mechanism's size: less of an equation is none.

const TRIED = 40; // Steps to a posture.

const BESIDE = 1e-6; // A small step of a coordinate.

const FARTHEST = 0.5; // The largest step of a coordinate [rad, or of the mechanism's size].

const HELD = 1e4; // The weight of equations that hold beside those that cannot.

const ON_THE_WAY = 8; // Designs between that of the file and another one.

class Postures {
  constructor(alive) {
    Object.assign(this, contents.live.posture, { alive, last: null });
    this.rows = this.loops.at(-1)?.rows[1] ?? 0;
    this.bodiesAt = this.rows * (1 + this.u.length);
    this.endsAt = this.bodiesAt + 12 * this.bodies.length;
    this.turnedAt = this.endsAt + 7 * this.loops.filter((loop) => loop.bodies.length).length;
    this.x = alive.engine.more + 8 * contents.live.numbers;
    this.y = this.x + 8 * (1 + this.u.length + this.q.length);
  }

  /** Equations of loops, their slopes, bodies and ends for coordinates, of the design that the engine is prepared for. */
  at(time, u, q) {
    const { calls, given } = this.alive.engine;
    new Float64Array(calls.memory.buffer, this.x).set([time, ...u, ...q]);
    calls.live_posture(given, this.x, this.y);
    return new Float64Array(calls.memory.buffer, this.y, this.turnedAt + q.length).slice();
  }

  /** The coordinates near others with the least sum of squares, in which each loop has a weight (Levenberg 1944, Marquardt 1963). What stays
   *  `open` needs second derivatives too: links in one line leave the direction of a step of Gauss and Newton open. */
  least({ time, u, q }, weights, open = false) {
    const { rows, free, loops } = this;
    const weight = new Float64Array(rows);
    loops.forEach((loop, k) => weight.fill(weights[k] ** 2, ...loop.rows));
    const sum = (found) => weight.reduce((all, w, i) => all + w * found[i] ** 2, 0);
    const moved = (step) => u.map((value, n) => value + (step[free.indexOf(n)] ?? 0));
    let [found, damping] = [this.at(time, u, q), 1e-9];
    let before = sum(found);
    for (let k = 0; k < TRIED && before > 1e-26 && damping < 1e6; k += 1) {
      const beside = open ? free.map((_, j) => this.at(time, moved(free.map((_, n) => (n === j ? BESIDE : 0))), q)) : [];
      const step = solved(this.normal(found, weight, beside), damping);
      const most = Math.max(...step.map(Math.abs));
      if (!(most > 1e-12)) break;
      const ahead = moved(step.map((value) => value * Math.min(1, FARTHEST / most)));
      const next = this.at(time, ahead, q);
      if (sum(next) < before) [u, found, before, damping] = [ahead, next, sum(next), Math.max(1e-12, damping / 10)];
      else damping *= 10;
    }
    return { time, u, q, found };
  }

  /** The equations of a step: the second derivatives of half the sum of squares, and the slope, turned, last; those of the loops' equations are
   *  taken of what these give `beside`, a step away. */
  normal(found, weight, beside) {
    const { rows, free, u } = this;
    return free.map((own) => {
      const row = new Float64Array(free.length + 1);
      for (let i = 0; i < rows; i += 1) {
        const at = rows + i * u.length;
        const pull = weight[i] * found[at + own];
        const turn = (weight[i] * found[i]) / BESIDE;
        for (let n = 0; n < free.length; n += 1) row[n] += pull * found[at + free[n]];
        for (let n = 0; n < beside.length; n += 1) row[n] += turn * (beside[n][at + own] - found[at + own]);
        row[free.length] -= pull * found[i];
      }
      return row;
    });
  }

  /** The coordinates from which those near others are sought: driven ones as they are now, free ones along the slopes where loops are less open
   *  there, so that screws keep count of their turns. */
  ahead(time, { u, q }) {
    const { rows, free, driven, alive } = this;
    const [now, still] = [this.at(time, u, q), [...u]];
    for (const [k, source, size] of driven) {
      still[k] = alive.engine.inputs[source] / size;
      for (let i = 0; i < rows; i += 1) now[i] += (still[k] - u[k]) * now[rows + i * u.length + k];
    }
    const moved = [...still];
    solved(this.normal(now, new Float64Array(rows).fill(1), []), 1e-9).forEach((step, j) => (moved[free[j]] += step));
    const [open, before] = [moved, still].map((at) => sizeOf(this.at(time, at, q).subarray(0, rows)));
    return open < before ? moved : still;
  }

  /** The loops that are open in a posture, by their numbers. */
  openOf({ found }) {
    return this.loops.flatMap(({ rows }, k) => (found.subarray(...rows).every((value) => Math.abs(value) < CLOSED) ? [] : [k]));
  }

  /** The posture of a design at an instant that is shown, near another one; with `weights` those loops stay open that are open there. Null
   *  where there are no such parts. */
  find(values, instant, from, weights = null) {
    const { alive, loops } = this;
    const time = alive.prepareAt(values, instant);
    if (time === null) return null;
    let found = { time, u: this.ahead(time, from), q: from.q };
    const whole = this.least(found, weights ?? loops.map(() => 1), Boolean(weights));
    let left = weights ? from.left : this.openOf(whole);
    if (!weights && left.length) {
      weights = loops.map(() => 0);
      loops.forEach((_, k) => {
        weights[k] = 1;
        const next = this.least(found, weights);
        if (this.openOf(next).some((n) => weights[n])) weights[k] = 0;
        else found = next;
      });
      left = loops.flatMap((_, k) => (weights[k] ? [] : [k]));
      weights = weights.map((closed) => (closed ? HELD : 1));
      found = this.least(found, weights, true);
    } else found = whole;
    const u = [...found.u];
    for (const k of this.resting) u[k] = 0;
    return { values, instant, numbers: alive.numbersNow(), u, q: [...found.found.subarray(this.turnedAt)], found: found.found, left, weights };
  }

  /** The posture at an instant of the last design that had a result: from that of the file at the first instant by small steps. */
  near(instant) {
    const { known, file } = this.alive;
    if (!this.last || this.last.values.some((value, n) => value !== known[n])) {
      this.last = { u: this.u, q: this.q };
      for (let k = 1; k <= ON_THE_WAY && this.last; k += 1) this.last = this.find(file.values.map((value, n) => value + (k / ON_THE_WAY) * (known[n] - value)), 0, this.last);
      if (this.last) this.last.values = known;
    }
    while (this.last && this.last.instant !== instant) this.last = this.find(known, this.last.instant + Math.sign(instant - this.last.instant), this.last);
    return this.last;
  }

  /** Place and axes of a body in a posture. */
  frameOf({ found }, name) {
    const at = this.bodiesAt + 12 * this.bodies.indexOf(name);
    const [origin, x, y, z] = [0, 3, 6, 9].map((k) => [...found.subarray(at + k, at + k + 3)]);
    return [origin, unit(x), y, z];
  }

  /** The gaps of a posture: their ends, and in words how wide they are. */
  gapsOf({ found, left }) {
    const joined = this.loops.filter((loop) => loop.bodies.length);
    return left.map((k) => {
      const { name, kind, rows, bodies } = this.loops[k];
      if (!bodies.length) return { ends: null, words: `${kind} '${name}' is ${format(found[rows[0]])} in place of 0` };
      const at = this.endsAt + 7 * joined.indexOf(this.loops[k]);
      const ends = [0, 3].map((n) => [...found.subarray(at + n, at + n + 3)]);
      const [wide, angle] = [sizeOf(less(...ends)), Math.asin(Math.min(1, found[at + 6]))];
      const turned = angle * extent.size > wide;
      const size = turned ? `${format((angle * 180) / Math.PI, 3)}°` : shown(wide, "m", 3);
      return { ends, size, words: `${bodies.join(" and ")} are ${turned ? `turned by ${size} against each other` : `${size} apart`} at ${kind} '${name}'` };
    });
  }
}

/** The solution of symmetric equations, rows with their right side last; damping makes their diagonal larger. */
function solved(table, damping) {
  const size = Math.max(...table.map((row, j) => Math.abs(row[j])), 1e-300);
  table.forEach((row, j) => (row[j] += damping * (Math.abs(row[j]) || size)));
  return eliminated(table).map(([value]) => value);
}
