// The designs of a sweep: their parameters and columns, which of them meet the reader's conditions, and which one is looked at.

const designs = { count: contents.designs.shown, numbers: array(contents.designs.numbers) };
const columns = [...contents.parameters, ...contents.columns].map((one) => ({ ...one, values: array(one.values) }));
const columnOf = new Map(columns.map((one) => [one.name, one]));
const status = array(contents.designs.status);
for (const one of columns) one.range = rangeOfColumn(one);
for (const one of columns) one.nothing = one.range[2] <= UNSEEN * Math.max(...columns.filter((other) => other.unit === one.unit).map((other) => other.range[2]));
const varying = columns.filter(varies);

const picked = { row: -1, where: "", met: null, watchers: new Set() };

/** The least, the largest, and the largest in size, of what a column is compared by, over designs with a result. */
function rangeOfColumn(column) {
  const values = Array.from(status, (state, row) => (state === 0 ? costOf(column, row) : NaN));
  const ends = values.some(Number.isFinite) ? endsOf(values) : [0, 0];
  return [...ends, largestOf(ends)];
}

/** The part of its size by which a column varies. */
function variation({ range: [low, high, size], nothing }) {
  return nothing || !size ? 0 : (high - low) / size;
}

/** Whether a column is not the same, or nothing, for all designs. */
function varies(column) {
  return variation(column) > 1e-9;
}

/** What a column is compared by: peaks by their size. */
function costOf(column, row) {
  return column.sized ? Math.abs(column.values[row]) : column.values[row];
}

/** Look at a design, by its row. */
function pick(row) {
  picked.row = row;
  for (const watcher of picked.watchers) watcher();
}

/** A unit, a product of names as `kN/mm^2`: its size in SI, and its powers of kg, m, s and rad; null for what is none. */
function unitOf(text) {
  const { names, signs, factor, unclear } = contents.units;
  const words = Array.from(text, (letter) => signs[letter] ?? letter).join("").replaceAll("**", "^");
  if (Object.hasOwn(names, words)) return names[words];
  const parts = /^([^/]*?)\s*(?:\/\s*(?:\((.*)\)|(\S+)))?$/.exec(words);
  if (!parts || new RegExp(`^(?:${unclear})$`).test(text)) return null;
  const found = [1, 0, 0, 0, 0];
  for (const [part, sign] of [[parts[1] === "1" ? "" : parts[1], 1], [parts[2] ?? parts[3] ?? "", -1]]) {
    for (const word of part.split(/\s*\*\s*|\s+/).filter(Boolean)) {
      const [, name = "", power = 1] = new RegExp(`^${factor}$`).exec(word) ?? [];
      if (!Object.hasOwn(names, name)) return null;
      found[0] *= names[name][0] ** (sign * power);
      for (const k of [1, 2, 3, 4]) found[k] += sign * power * names[name][k];
    }
  }
  return found;
}

/** The factor of numbers in a unit to that of a column; throws an error for a unit of another kind. */
function factorOf(word, column) {
  const [given, own] = [unitOf(word), unitOf(column.unit)];
  if (!given) throw new Error(`unknown unit ${word}`);
  const [kind, expected] = [given, own].map((unit) => contents.units.kinds[unit?.slice(1).join()] ?? "another quantity");
  if (given.slice(1).join() !== own?.slice(1).join()) throw new Error(`${word} is ${kind}; expected ${expected} [${column.unit}] after ${column.name}`);
  return given[0] / own[0];
}

/** Read conditions such as `l<0.3, peak:effort:O<=12 kN m`; throws an error that names what is none. */
function conditionsOf(text) {
  return text.split(/[,;]|\s+and\s+/).filter((word) => word.trim()).map((word) => {
    const found = /^\s*([^<>=!]+?)\s*(<=|>=|==|!=|=|<|>)\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?|\S+)\s*(\S.*?)?\s*$/i.exec(word);
    const column = found && columnOf.get(found[1]);
    if (!column) throw new Error(found ? `unknown column ${found[1]}` : `expected a condition like l<0.3, got ${word.trim()}`);
    const value = Number(found[3]) * (found[4] ? factorOf(found[4], column) : 1);
    if (Number.isNaN(value)) throw new Error(`expected a number after ${found[1]} ${found[2]}, got ${found[3]}`);
    return { column, relation: found[2], value };
  });
}

function holds({ column, relation, value }, row) {
  const own = costOf(column, row);
  const same = Math.abs(own - value) <= 1e-9 * Math.abs(value);
  if (Number.isNaN(own)) return false;
  return { "<": own < value && !same, ">": own > value && !same, "<=": own < value || same, ">=": own > value || same, "=": same, "==": same, "!=": !same }[relation];
}

/** Have only the designs that meet conditions shown; returns what is wrong with them, or nothing. */
function filter(text) {
  try {
    const conditions = conditionsOf(text);
    picked.met = Array.from({ length: designs.count }, (_, row) => row).filter((row) => conditions.every((one) => holds(one, row)));
    picked.where = text;
  } catch (error) {
    return error.message;
  }
  for (const watcher of picked.watchers) watcher();
  return "";
}

/** The rows, of those that meet the conditions, that have a number in all of some columns. */
function comparable(...wanted) {
  return picked.met.filter((row) => status[row] === 0 && wanted.every((column) => Number.isFinite(costOf(column, row))));
}

/** The rows, of those that meet the conditions, of which no other is as good in both columns and better in one: less is better. */
function frontOf(first, second) {
  let least = Infinity;
  const cheapest = (a, b) => costOf(first, a) - costOf(first, b) || costOf(second, a) - costOf(second, b);
  return comparable(first, second).sort(cheapest).filter((row) => {
    const better = costOf(second, row) < least;
    if (better) least = costOf(second, row);
    return better;
  });
}

/** A design in words: its number and parameters. */
function designWords(row) {
  const described = contents.parameters.map((one) => `${one.name} = ${shown(columnOf.get(one.name).values[row], one.unit)}`);
  return `design ${designs.numbers[row]}: ${described.join(", ")}`;
}

/** What a column of a design is, in words. */
function columnWords(column, row) {
  const value = column.values[row];
  return Number.isNaN(value) ? "–" : shown(column.nothing ? 0 : value, column.unit, 5);
}

filter("");
