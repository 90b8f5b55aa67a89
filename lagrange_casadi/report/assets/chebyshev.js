// Polynomials on -1 to 1 as sums of Chebyshev's: values, slopes and zeros.

/** The coefficients of the polynomial that has values at the extrema of Chebyshev's polynomial, the first at 1, the last at -1. */
function chebyshevOf(values) {
  const n = values.length - 1;
  return Float64Array.from({ length: n + 1 }, (_, k) => {
    let sum = 0;
    for (let j = 0; j <= n; j += 1) sum += (j % n ? 1 : 0.5) * values[j] * Math.cos((Math.PI * j * k) / n);
    return ((k % n ? 2 : 1) / n) * sum;
  });
}

/** A sum at a place (Clenshaw's way). */
function chebyshevAt(c, v) {
  let [one, two] = [0, 0];
  for (let k = c.length - 1; k > 0; k -= 1) [one, two] = [c[k] + 2 * v * one - two, one];
  return c[0] + v * one - two;
}

/** The slope of a sum, as another one. */
function slopeOf(c) {
  const n = c.length - 1;
  const found = new Float64Array(Math.max(1, n));
  for (let k = n; k > 0; k -= 1) found[k - 1] = (k + 1 < n ? found[k + 1] : 0) + 2 * k * c[k];
  found[0] /= 2;
  return found;
}

/** Add the product of two sums to a third. */
function addProduct(found, a, b) {
  for (let i = 0; i < a.length; i += 1) {
    for (let j = 0; j < b.length; j += 1) {
      const half = (a[i] * b[j]) / 2;
      found[i + j] += half;
      found[Math.abs(i - j)] += half;
    }
  }
}

const NOTHING = 4e-16; // Over the largest coefficient: what is smaller is rounding, and no degree.

/** The zeros of a sum between two places, in order. */
function zerosOf(c, low, high) {
  let n = c.length - 1;
  let most = 0;
  for (let k = 0; k <= n; k += 1) most = Math.max(most, Math.abs(c[k]));
  while (n > 0 && Math.abs(c[n]) <= NOTHING * most) n -= 1;
  if (n === 0) return [];
  if (n === 1) return within([-c[0] / c[1]], low, high);
  if (n === 2) {
    const [a, b, constant] = [2 * c[2], c[1], c[0] - c[2]];
    const root = b * b - 4 * a * constant;
    if (!(root >= 0)) return [];
    const q = -(b + (b < 0 ? -1 : 1) * Math.sqrt(root)) / 2;
    return within(q ? [q / a, constant / q].sort((x, y) => x - y) : [0], low, high);
  }
  // It is monotonic between two zeros of its slope.
  const cut = c.subarray(0, n + 1);
  const ends = [low, ...zerosOf(slopeOf(cut), low, high), high];
  const found = [];
  for (let k = 1; k < ends.length; k += 1) {
    const zero = zeroBetween(cut, ends[k - 1], ends[k]);
    if (zero !== null) found.push(zero);
  }
  return found;
}

function within(places, low, high) {
  return places.filter((place) => place > low && place < high);
}

/** The zero of what is monotonic between two places, by Newton's method held between them; null where it has none. */
function zeroBetween(c, a, b) {
  const rises = chebyshevAt(c, a) <= 0;
  if (rises === chebyshevAt(c, b) <= 0) return null;
  const slope = slopeOf(c);
  let v = (a + b) / 2;
  for (let k = 0; k < 80; k += 1) {
    const value = chebyshevAt(c, v);
    if (value <= 0 === rises) a = v;
    else b = v;
    let ahead = v - value / chebyshevAt(slope, v);
    if (!(ahead > a && ahead < b)) ahead = (a + b) / 2;
    const moved = Math.abs(ahead - v);
    v = ahead;
    if (!(moved > 1e-13)) break;
  }
  return v;
}
