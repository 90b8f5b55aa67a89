// Polynomials from 0 to 1 in Bernstein's form, as base/bernstein.py has them: values, slopes, parts and zeros. They are asked for at every
// instant of every link while a slider moves, so nothing is made anew: a polynomial is an array of ordinates and a degree.

const binomials = [Float64Array.of(1)];

function binomialsOf(n) {
  for (let k = binomials.length; k <= n; k += 1) binomials.push(Float64Array.from({ length: k + 1 }, (_, i) => (i ? binomials[k - 1][i - 1] : 0) + (i < k ? binomials[k - 1][i] : 0)));
  return binomials[n];
}

/** The value of a polynomial of degree n at a place. */
function valueAt(c, n, x) {
  if (n === 0) return c[0];
  const many = binomialsOf(n);
  let sum = c[0] * (1 - x);
  let power = x;
  for (let i = 1; i < n; i += 1) {
    sum = (sum + power * many[i] * c[i]) * (1 - x);
    power *= x;
  }
  return sum + power * c[n];
}

/** The solutions of equations, rows with their right sides last, by Gauss's elimination, which changes these rows. */
function eliminated(rows) {
  const many = rows.length;
  rows.forEach((row, j) => {
    for (const other of rows) {
      const part = other[j] / row[j];
      if (other !== row) for (let n = j; n < row.length; n += 1) other[n] -= part * row[n];
    }
  });
  return rows.map((row, j) => Array.from(row.slice(many), (value) => value / row[j]));
}

const interpolations = [];

/** Places from 0 to 1 for a degree, and the rows of factors that make ordinates of values there. */
function interpolation(n) {
  if (interpolations[n]) return interpolations[n];
  const places = Float64Array.from({ length: n + 1 }, (_, j) => (1 - Math.cos((Math.PI * j) / n)) / 2);
  const unit = (k) => Array.from(places, (_, j) => Number(j === k));
  const rows = Array.from(places, (x, j) => [...unit(j).map((_, i) => valueAt(unit(i), n, x)), ...unit(j)]);
  // No pivot is small, for every minor is positive.
  interpolations[n] = { places, factors: eliminated(rows).map((row) => Float64Array.from(row)) };
  return interpolations[n];
}

/** The ordinates of the polynomial that has values at the places of `interpolation`, into `found`; returns whether any is another than before. */
function ordinatesInto(found, values) {
  let changed = false;
  interpolation(values.length - 1).factors.forEach((row, i) => {
    let sum = 0;
    for (let j = 0; j < row.length; j += 1) sum += row[j] * values[j];
    if (sum !== found[i]) changed = true;
    found[i] = sum;
  });
  return changed;
}

/** The slope of a polynomial of degree n, into `found`. */
function slopeInto(found, c, n) {
  for (let i = 0; i < n; i += 1) found[i] = n * (c[i + 1] - c[i]);
}

/** Add the product of two polynomials of degrees n and m to a third. */
function addProduct(found, a, n, b, m) {
  const [left, right, both] = [binomialsOf(n), binomialsOf(m), binomialsOf(n + m)];
  for (let i = 0; i <= n; i += 1) for (let j = 0; j <= m; j += 1) found[i + j] += a[i] * b[j] * ((left[i] * right[j]) / both[i + j]);
}

/** Have a polynomial of degree n as that of a part of 0 to 1 (de Casteljau). */
function cutTo(c, n, from, to) {
  for (let i = 1; i <= n; i += 1) for (let k = n; k >= i; k -= 1) c[k] = c[k - 1] + to * (c[k] - c[k - 1]);
  const first = to > 0 ? from / to : 0;
  for (let i = 1; i <= n; i += 1) for (let k = 0; k <= n - i; k += 1) c[k] += first * (c[k + 1] - c[k]);
}

/** Room for the work on polynomials of each degree: the slope, and the zeros. */
const rooms = [];

function roomFor(n) {
  while (rooms.length <= n) rooms.push({ slope: new Float64Array(rooms.length + 1), at: new Float64Array(rooms.length + 1), count: 0 });
  return rooms[n];
}

/** The zeros of a polynomial of degree n between 0 and 1, in order: `at`, so many as `count`. They hold until the next call. */
function zerosOf(c, n) {
  const found = roomFor(n);
  found.count = 0;
  if (n === 1) takeZero(found, c[0] / (c[0] - c[1]));
  if (n === 2) {
    const [half, bend] = [c[1] - c[0], c[0] - 2 * c[1] + c[2]];
    const root = Math.sqrt(half * half - bend * c[0]);
    const far = -half - (half > 0 ? root : -root);
    const [one, other] = [far / bend, c[0] / far];
    takeZero(found, one < other ? one : other);
    takeZero(found, one < other ? other : one);
  }
  if (n < 3) return found;
  let changes = 0;
  for (let i = 0; i < n; i += 1) if (c[i] < 0 !== c[i + 1] < 0) changes += 1;
  if (!changes) return found;
  slopeInto(found.slope, c, n);
  // With one change there is one zero; with more there is one or none between two zeros of the slope.
  const turns = changes > 1 ? zerosOf(found.slope, n - 1) : { count: 0 };
  let from = 0;
  for (let k = 0; k <= turns.count; k += 1) {
    const to = k < turns.count ? turns.at[k] : 1;
    takeZero(found, zeroBetween(c, found.slope, n, from, to));
    from = to;
  }
  return found;
}

function takeZero(found, place) {
  if (place > 0 && place < 1) found.at[found.count++] = place;
}

/** The zero of what is monotonic between two places, of a degree n and with a slope, by Newton's method held between them; NaN where it has none. */
function zeroBetween(c, slope, n, a, b) {
  const rises = valueAt(c, n, a) < 0;
  if (rises === valueAt(c, n, b) < 0) return NaN;
  let x = (a + b) / 2;
  for (let k = 0; k < 80; k += 1) {
    const value = valueAt(c, n, x);
    if (value < 0 === rises) a = x;
    else b = x;
    let ahead = value ? x - value / valueAt(slope, n - 1, x) : x;
    if (!(ahead >= a && ahead <= b)) ahead = (a + b) / 2;
    const moved = Math.abs(ahead - x);
    x = ahead;
    if (!(moved > 1e-13)) break;
  }
  return x;
}
