// Units that a person reads, chosen by how large values are; or those of the file, on a switch.

const reading = { si: false, watchers: new Set(), tables: new Set() };

/** Do something now, and whenever numbers are to be shown anew. */
function showing(describe) {
  describe();
  reading.watchers.add(describe);
}

/** Switch between readable units and SI, and have all that shows numbers do it anew. */
function setSi(si) {
  reading.si = si;
  for (const watcher of [...reading.watchers, ...reading.tables]) watcher();
}

const STEPS = [
  [1e9, "G", 1e-9],
  [1e6, "M", 1e-6],
  [1e3, "k", 1e-3],
  [0.1, "", 1],
  [1e-4, "m", 1e3],
  [0, "µ", 1e6],
];

const PREFIXED = new Set(["N", "N m", "Pa", "W", "J", "N/m", "N s/m"]);

/** How values of a unit, of which the largest has a size, are shown: by which factor, and in what. */
function scaleFor(unit, size) {
  if (reading.si || !unit || unit === "1") return { factor: 1, unit: prettyUnit(unit) };
  if (unit === "rad") return { factor: 180 / Math.PI, unit: "deg" };
  if (unit === "rad/s") return size >= 10 ? { factor: 30 / Math.PI, unit: "rpm" } : { factor: 180 / Math.PI, unit: "deg/s" };
  if (unit === "m" || unit === "s" || unit === "m/s") {
    if (!size || size >= (unit === "m/s" ? 0.1 : 1)) return { factor: 1, unit };
    return size >= 1e-3 ? { factor: 1e3, unit: `m${unit}` } : { factor: 1e6, unit: `µ${unit}` };
  }
  if (PREFIXED.has(unit) && size) {
    const [, prefix, factor] = STEPS.find(([least]) => size >= least);
    return { factor, unit: prefix + prettyUnit(unit) };
  }
  return { factor: 1, unit: prettyUnit(unit) };
}

function prettyUnit(unit) {
  if (!unit || unit === "1") return "";
  return unit.replace(/\^2/g, "²").replace(/\^3/g, "³").replace(/ /g, "\u00b7");
}

/** A number to so many digits that count. */
function format(value, digits = 5) {
  if (!Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e7 || size < 1e-4) {
    const [mantissa, exponent] = value.toExponential(digits - 1).split("e");
    return `${plain(mantissa)}·10${raised(Number(exponent))}`;
  }
  return plain(value.toPrecision(digits));
}

/** The digits of a number without noughts at its end, with a sign that is as wide as a plus. */
function plain(digits) {
  return minus(String(Number(digits)));
}

function minus(text) {
  return text.replace("-", "\u2212");
}

const raised = (exponent) => Array.from(String(exponent), (sign) => "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"["-0123456789".indexOf(sign)]).join("");

/** A value with its unit. */
function shown(value, unit, digits = 5, size = Math.abs(value)) {
  const scale = scaleFor(unit, size);
  return `${format(value * scale.factor, digits)}${scale.unit ? `\u00a0${scale.unit}` : ""}`;
}

const UNSEEN = 1e-12; // Over the largest value: what is smaller is the rounding of nothing.

/** What stands at an axis: words, and the unit in brackets. */
function labelled(words, unit) {
  return unit ? `${words} [${unit}]` : words;
}

/** Round steps between two ends: about so many, at numbers that people count by. */
function ticksBetween(low, high, about) {
  if (!(high > low)) return [low];
  return multiplesBetween(low, high, roundStep((high - low) / Math.max(about, 1), [1, 2, 2.5, 5, 10]));
}

/** The least of some parts, the last of which is 10, times a power of ten, that is about a size or more. */
function roundStep(size, parts) {
  const power = 10 ** Math.floor(Math.log10(size));
  return power * parts.find((part) => part * power >= size * 0.999);
}

function multiplesBetween(low, high, step) {
  const found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + 1e-9 * step; k += 1) found.push(k * step);
  return found;
}

/** The same for angles in degrees, by which people count in thirds of a right angle. */
function angleTicks(low, high, about) {
  const steps = [1, 2, 5, 10, 15, 30, 45, 60, 90, 180, 360, 720, 1440];
  const step = steps.find((one) => (high - low) / one <= about * 1.2);
  return step && high - low >= 4 ? multiplesBetween(low, high, step) : ticksBetween(low, high, about);
}
