// What the page holds. Arrays are decoded when they are first asked for.

const contents = JSON.parse(document.getElementById("contents").textContent);

const numbers = (() => {
  const text = atob(contents.numbers);
  const bytes = new Uint8Array(text.length);
  for (let k = 0; k < text.length; k += 1) bytes[k] = text.charCodeAt(k);
  return new Float64Array(bytes.buffer);
})();

const decoded = new Map();

/** An array by its number. */
function array(number) {
  if (!decoded.has(number)) {
    const { at, count, value } = contents.arrays[number];
    decoded.set(number, at === undefined ? new Float64Array(count).fill(value) : numbers.subarray(at, at + count));
  }
  return decoded.get(number);
}

const instants = { count: contents.instants.shown, total: contents.instants.total, t: array(contents.instants.t) };

const seriesByName = new Map(contents.series.map((one) => [one.name, one]));
const rowByName = new Map(contents.rows.map((one) => [one.name, one]));

/** What a series or row is called where its kind is plain: "rod: bending moment". */
function titleOf(one) {
  return one.part && one.what ? `${one.part}: ${one.what}` : one.part || one.what;
}

let largest = new WeakMap();

/** The largest size among values, those that are no numbers left out. */
function largestOf(values) {
  if (!largest.has(values)) {
    let found = 0;
    for (const value of values) if (Math.abs(value) > found) found = Math.abs(value);
    largest.set(values, found);
  }
  return largest.get(values);
}

/** The number of the instant that is nearest to a time. */
function instantAt(time) {
  const t = instants.t;
  let low = 0;
  let high = t.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (t[middle] <= time) low = middle;
    else high = middle;
  }
  return Math.abs(t[high] - time) < Math.abs(t[low] - time) ? high : low;
}
