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

/** Ends what listens to the whole window, where a viewer of other contents takes the place of this one. */
const ended = new AbortController();

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
