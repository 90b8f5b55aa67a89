// What the page holds.

const contents = JSON.parse(document.getElementById("contents").textContent);

/** The bytes of a text in base 64. */
function bytesOf(text) {
  const letters = atob(text);
  const bytes = new Uint8Array(letters.length);
  for (let k = 0; k < letters.length; k += 1) bytes[k] = letters.charCodeAt(k);
  return bytes;
}

const numbers = new Float64Array(bytesOf(contents.numbers).buffer);

const arrays = contents.arrays.map(({ at, count, value }) => (at === undefined ? new Float64Array(count).fill(value) : numbers.subarray(at, at + count)));

/** An array by its number. */
const array = (number) => arrays[number];

/** Ends what listens to the whole window, where a viewer of other contents takes the place of this one. */
const ended = new AbortController();

/** What is found of arrays and rows, each once, until they hold other numbers. */
let remembered = new WeakMap();

function once(of, find) {
  if (!remembered.has(of)) remembered.set(of, find(of));
  return remembered.get(of);
}

/** The largest size among values, those that are no numbers left out. */
function largestOf(values) {
  return once(values, () => {
    let most = 0;
    for (const value of values) if (Math.abs(value) > most) most = Math.abs(value);
    return most;
  });
}
