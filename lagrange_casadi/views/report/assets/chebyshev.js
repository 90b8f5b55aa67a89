// Polynomials on -1 to 1 as sums of Chebyshev's: values, slopes and zeros. They are asked for at every instant of every link while a
// slider moves, so nothing is made anew: a sum is an array and how many of its numbers count.

/** The coefficients of the polynomial that has values at the extrema of Chebyshev's polynomial, the first at 1, the last at -1, into
 *  `found`; returns whether any is another than before. */
function chebyshevInto(found, values) {
  const n = values.length - 1;
  const cosines = cosinesOf(n);
  let changed = false;
  for (let k = 0; k <= n; k += 1) {
    let sum = 0;
    for (let j = 0; j <= n; j += 1) sum += (j % n ? 1 : 0.5) * values[j] * cosines[(j * k) % (2 * n)];
    const value = ((k % n ? 2 : 1) / n) * sum;
    if (value !== found[k]) changed = true;
    found[k] = value;
  }
  return changed;
}

const circles = [];

/** The cosines of the multiples of a half turn's n-th part, over a whole turn. */
function cosinesOf(n) {
  circles[n] ??= Float64Array.from({ length: 2 * n }, (_, k) => Math.cos((Math.PI * k) / n));
  return circles[n];
}

/** A sum at a place (Clenshaw's way). */
function chebyshevAt(c, v, many) {
  let [one, two] = [0, 0];
  for (let k = many - 1; k > 0; k -= 1) {
    const next = c[k] + 2 * v * one - two;
    two = one;
    one = next;
  }
  return c[0] + v * one - two;
}

/** The slope of a sum, into `found`; returns how many numbers it has. */
function slopeInto(found, c, many) {
  const n = many - 1;
  found[0] = 0;
  for (let k = n; k > 0; k -= 1) found[k - 1] = (k + 1 < n ? found[k + 1] : 0) + 2 * k * c[k];
  found[0] /= 2;
  return Math.max(1, n);
}

/** Add the product of two sums to a third. */
function addProduct(found, a, many, b, others) {
  for (let i = 0; i < many; i += 1) {
    for (let j = 0; j < others; j += 1) {
      const half = (a[i] * b[j]) / 2;
      found[i + j] += half;
      found[Math.abs(i - j)] += half;
    }
  }
}

const NOTHING = 4e-16; // Over the largest coefficient: what is smaller is rounding, and no degree.

/** Room for the work on sums of each degree: the slope, and the zeros. */
const rooms = [];

function roomFor(n) {
  while (rooms.length <= n) rooms.push({ slope: new Float64Array(rooms.length + 1), at: new Float64Array(rooms.length + 1), count: 0 });
  return rooms[n];
}

/** The zeros of a sum between two places, in order: `at`, so many as `count`. They hold until the next call. */
function zerosOf(c, many, low, high) {
  let n = many - 1;
  let most = 0;
  for (let k = 0; k <= n; k += 1) {
    const size = Math.abs(c[k]);
    if (size > most) most = size;
  }
  while (n > 0 && Math.abs(c[n]) <= NOTHING * most) n -= 1;
  const found = roomFor(n);
  found.count = 0;
  if (n === 0) return found;
  if (n === 1) {
    takeZero(found, -c[0] / c[1], low, high);
    return found;
  }
  if (n === 2) {
    const a = 2 * c[2];
    const b = c[1];
    const constant = c[0] - c[2];
    const root = b * b - 4 * a * constant;
    if (!(root >= 0)) return found;
    const q = -(b + (b < 0 ? -1 : 1) * Math.sqrt(root)) / 2;
    const one = q ? q / a : 0;
    const other = q ? constant / q : 0;
    takeZero(found, Math.min(one, other), low, high);
    if (q) takeZero(found, Math.max(one, other), low, high);
    return found;
  }
  // It is monotonic between two zeros of its slope.
  const count = slopeInto(found.slope, c, n + 1);
  const turns = zerosOf(found.slope, count, low, high);
  let from = low;
  for (let k = 0; k <= turns.count; k += 1) {
    const to = k < turns.count ? turns.at[k] : high;
    const zero = zeroBetween(c, found.slope, n, from, to);
    if (!Number.isNaN(zero)) found.at[found.count++] = zero;
    from = to;
  }
  return found;
}

function takeZero(found, place, low, high) {
  if (place > low && place < high) found.at[found.count++] = place;
}

/** The zero of what is monotonic between two places, of a degree n and with a slope, by Newton's method held between them; NaN where it has none. */
function zeroBetween(c, slope, n, a, b) {
  const rises = chebyshevAt(c, a, n + 1) <= 0;
  if (rises === chebyshevAt(c, b, n + 1) <= 0) return NaN;
  let v = (a + b) / 2;
  for (let k = 0; k < 80; k += 1) {
    const value = chebyshevAt(c, v, n + 1);
    if (value <= 0 === rises) a = v;
    else b = v;
    let ahead = v - value / chebyshevAt(slope, v, n);
    if (!(ahead > a && ahead < b)) ahead = (a + b) / 2;
    const moved = Math.abs(ahead - v);
    v = ahead;
    if (!(moved > 1e-13)) break;
  }
  return v;
}

/** The ordinates of Bernstein of a sum on -1 to 1, into `found`; returns that. The polynomial is between the least and the largest. */
function ordinatesInto(found, c) {
  const many = c.length;
  const factors = ordinateFactors(many - 1);
  for (let j = 0, r = 0; j < many; j += 1) {
    let sum = 0;
    for (let k = 0; k < many; k += 1, r += 1) sum += factors[r] * c[k];
    found[j] = sum;
  }
  return found;
}

const factorsKnown = [];

/** By which factors the coefficients of a sum of a degree give its ordinates of Bernstein on -1 to 1, those of an ordinate after another. */
function ordinateFactors(n) {
  if (factorsKnown[n]) return factorsKnown[n];
  const choose = (m, k) => {
    let found = 1;
    for (let i = 1; i <= k; i += 1) found = (found * (m - k + i)) / i;
    return found;
  };
  const found = new Float64Array((n + 1) ** 2);
  for (let k = 0; k <= n; k += 1) {
    // Of degree k they are known; a higher one spreads them.
    const own = Array.from({ length: k + 1 }, (_, i) => ((k - i) % 2 ? -1 : 1) * choose(2 * k, 2 * i));
    for (let j = 0; j <= n; j += 1) {
      let sum = 0;
      for (let i = Math.max(0, j - n + k); i <= Math.min(j, k); i += 1) sum += own[i] * choose(n - k, j - i);
      found[j * (n + 1) + k] = sum / choose(n, j);
    }
  }
  factorsKnown[n] = found;
  return found;
}
