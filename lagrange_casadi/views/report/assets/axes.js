// What charts have in common: curves, scales, axes, and the words beside the pointer.

const BODY_COLOURS = 8;
const DASHES = ["", "7 3", "2 3", "10 3 2 3", "4 2", "1 2"];
const FIELD = { left: 62, right: 14, top: 20, bottom: 40, height: 150, between: 24 };

/** How the curve with a number is drawn, so that curves are distinguished without colours too. */
const lineOf = (k) => ({ class: `curve of-${k % BODY_COLOURS}`, "stroke-dasharray": DASHES[k % DASHES.length] });

/** A piece of that curve, for a legend. */
function swatch(k) {
  return drawn("svg", { width: 26, height: 8, "aria-hidden": "true" }, drawn("line", { x1: 1, x2: 25, y1: 4, y2: 4, ...lineOf(k) }));
}

/** A sheet of two layers: what stands still, and above it what goes with the motion, so that curves are painted once. */
class Sheet {
  /** Its plot says what is `under` an event, if anything; `describe` has the words for that, `point` marks it, and `press` takes it. */
  constructor(kind, words, plot) {
    [this.still, this.moving] = [drawn("svg"), drawn("svg", { class: "moving", "aria-hidden": "true" })];
    this.body = element("div", { class: `chart ${kind}`, tabindex: 0, role: "img", "aria-label": words }, this.still, this.moving);
    this.cursor = drawn("g", { class: "cursor" });
    this.pointer = drawn("g", { class: "cursor pointed" });
    this.moving.append(this.cursor, this.pointer);
    const hover = (event) => {
      const found = event && plot.under(event);
      if (found === null) this.pointer.replaceChildren();
      else plot.point?.(found);
      showTip(found === null ? null : event, ...(found === null ? [] : plot.describe(found)));
    };
    this.body.addEventListener("pointermove", hover);
    this.body.addEventListener("pointerleave", () => hover(null));
    this.body.addEventListener("click", (event) => {
      const found = plot.under(event);
      if (found !== null) plot.press?.(found);
    });
  }

  /** Give it a size, and what stands still on it. */
  fill(width, height, ...still) {
    this.width = width;
    for (const layer of [this.still, this.moving]) {
      for (const [name, value] of [["viewBox", `0 0 ${width} ${height}`], ["width", width], ["height", height]]) layer.setAttribute(name, value);
    }
    this.still.replaceChildren(...still);
  }

  /** Where an event is on it. */
  at(event) {
    const frame = this.body.getBoundingClientRect();
    return [event.clientX - frame.left, event.clientY - frame.top].map((value) => (value * this.width) / frame.width);
  }
}

/** Show the instant that a reader has pressed on. */
function seekTo(instant) {
  player.pause();
  player.seek(instant);
}

/** Everything that can be an axis or a curve, by name; `t` and `over` are the instants. */
function curveOf(name) {
  if (name === "t") return { name, title: "time", unit: "s", values: instants.t };
  if (name === "over" && over) return { name, title: over.joint, unit: over.unit, values: array(over.values) };
  const one = seriesByName.get(name);
  const ending = one.group === "section" ? ", largest along the link" : "";
  return { name, title: titleOf(one) + ending, unit: one.unit, values: array(one.values), places: one.places === null ? null : array(one.places) };
}

/** A section force at a ratio of a link, over all instants; it is found anew by `renew`. */
function curveOfSection(section, force, ratio) {
  const values = new Float64Array(instants.count);
  const renew = () => sectionOverInstants(section, force.name, ratio, values);
  renew();
  return { name: "", title: force.what, unit: force.unit, values, renew };
}

/** What a series or row is called where its kind is plain: "rod: bending moment". */
function titleOf(one) {
  return one.part && one.what ? `${one.part}: ${one.what}` : one.part || one.what;
}

/** The entries of a list of quantities, by kind. */
function seriesEntries(series = contents.series) {
  const groups = Object.entries(contents.groups).map(([group, head]) => {
    const own = series.filter((one) => one.group === group);
    return [group === "section" ? `${head}, largest along the link` : head, own.map((one) => [one.name, titleOf(one)])];
  });
  return groups.filter(([, own]) => own.length);
}

/** The ends of the values of some arrays. */
function endsOf(...arrays) {
  let [low, high] = [Infinity, -Infinity];
  for (const values of arrays) {
    for (const value of values) {
      if (value < low) low = value;
      if (value > high) high = value;
    }
  }
  return low <= high ? [low, high] : [0, 1];
}

const ROUNDING = 1e-9; // What differs by less, over its size, is the same but for rounding.

/** A scale: from values to points of the sheet. `factor` brings them to the unit that is read. */
function scaled([low, high], [from, to], unit, title, room = 0) {
  const { factor, unit: readable } = scaleFor(unit, Math.max(Math.abs(low), Math.abs(high)));
  const apart = high - low > ROUNDING * Math.max(Math.abs(low), Math.abs(high));
  const wide = apart ? high - low : Math.abs(high) || 1;
  const [a, b] = apart ? [low - room * wide, high + room * wide] : [low - wide / 2, high + wide / 2];
  const at = (value) => from + ((value - a) / (b - a)) * (to - from);
  const back = (point) => a + ((point - from) / (to - from)) * (b - a);
  const about = Math.max(2, Math.floor(Math.abs(to - from) / (to > from ? 76 : 34)));
  const angular = readable === "deg";
  const ticks = (angular ? angleTicks : ticksBetween)(a * factor, b * factor, about).map((tick) => [at(tick / factor), tick]);
  const step = ticks.length > 1 ? Math.abs(ticks[1][1] - ticks[0][1]) : 1;
  const decimals = Math.max(0, Math.ceil(-Math.log10(step) - 1e-9));
  const size = Math.max(...ticks.map(([, tick]) => Math.abs(tick)), 0);
  const describe = (tick) => (size >= 1e6 || (size && size < 1e-4) ? format(tick, 3) : plain(tick.toFixed(Math.min(8, decimals + 1))));
  return { at, back, ticks, describe, factor, unit: readable, title, label: labelled(title, readable), from, to, low: a, high: b };
}

/** Whether values with these ends are all on a scale, and take up much of it. */
function fitsIn([low, high], scale) {
  return low >= scale.low && high <= scale.high && high - low >= 0.4 * (scale.high - scale.low);
}

/** The lines, numbers and words of two scales around a field; a scale upwards without a title has its unit above it. */
function axesOf(x, y, bottom = true) {
  const middle = (y.from + y.to) / 2;
  return drawn("g", { class: "axes" },
    y.ticks.flatMap(([at, tick]) => [
      drawn("line", { x1: x.from, x2: x.to, y1: at, y2: at, class: tick === 0 ? "zero" : "net" }),
      drawn("text", { x: x.from - 7, y: at, class: "y" }, y.describe(tick)),
    ]),
    x.ticks.flatMap(([at, tick]) => [
      drawn("line", { x1: at, x2: at, y1: y.from, y2: y.to, class: "net" }),
      bottom && drawn("text", { x: at, y: y.from + 15, class: "x" }, x.describe(tick)),
    ]),
    drawn("line", { x1: x.from, x2: x.to, y1: y.from, y2: y.from, class: "edge" }),
    y.title ? drawn("text", { x: 14, y: middle, class: "label", transform: `rotate(-90 14 ${middle})` }, y.label)
      : drawn("text", { x: x.from - 7, y: y.to - 7, class: "unit" }, y.unit || "1"),
    bottom && drawn("text", { x: (x.from + x.to) / 2, y: y.from + FIELD.bottom - 6, class: "label" }, x.label));
}

/** The words at a bar of colours, whose middle is at `x`: the ends of its values, and their unit. */
function keyOf(scale, x, up, low, high) {
  const text = (words, y) => drawn("text", { x, y, class: "key" }, words);
  return [text(format(high * scale.factor, 3), up.to + 9), text(format(low * scale.factor, 3), up.from - 18), text(scale.unit, up.from - 2)];
}

/** A curve as the path of an element, broken where there are no numbers. Of more instants than its columns, each so many points wide,
 *  can show, a column has its lowest and its highest. */
function pathOf(xs, ys, x, y, column) {
  const [perX, perY] = [(x.to - x.from) / (x.high - x.low), (y.to - y.from) / (y.high - y.low)];
  const across = (i) => Math.round(10 * (x.from + (xs[i] - x.low) * perX)) / 10;
  const up = (i) => Math.round(10 * (y.from + (ys[i] - y.low) * perY)) / 10;
  const many = column && xs.length > 2 * ((x.to - x.from) / column);
  let [path, pen] = ["", "M"];
  for (let i = 0; i < xs.length; i += 1) {
    if (!Number.isFinite(xs[i]) || !Number.isFinite(ys[i])) {
      pen = "M";
      continue;
    }
    path += `${pen}${across(i)} ${up(i)}`;
    pen = "L";
    if (!many) continue;
    const end = Math.floor(across(i) / column);
    let [low, high, last] = [i, i, i];
    while (last + 1 < xs.length && Number.isFinite(ys[last + 1]) && Math.floor(across(last + 1) / column) === end) {
      last += 1;
      if (ys[last] < ys[low]) low = last;
      if (ys[last] > ys[high]) high = last;
    }
    for (const k of [Math.min(low, high), Math.max(low, high)]) if (k > i) path += `L${across(k)} ${up(k)}`;
    i = last;
  }
  return path;
}

const tip = element("div", { class: "tip", role: "presentation", hidden: true });

/** Show lines of names and values beside the pointer; none to hide them. */
function showTip(event, head, lines) {
  tip.hidden = !event;
  if (!event) return;
  tip.replaceChildren(element("div", { class: "head" }, head), listOf(lines));
  const { width, height } = tip.getBoundingClientRect();
  const x = event.clientX + 16 + width > window.innerWidth ? event.clientX - 16 - width : event.clientX + 16;
  const y = Math.max(4, Math.min(window.innerHeight - height - 4, event.clientY + 14));
  tip.style.left = `${Math.max(4, x)}px`;
  tip.style.top = `${y}px`;
}

/** Of so many things the number of the one that is least away, and less than `within`; else null. */
function closest(count, awayOf, within = Infinity) {
  let [best, least] = [null, within];
  for (let k = 0; k < count; k += 1) {
    const away = awayOf(k);
    if (away < least) [best, least] = [k, away];
  }
  return best;
}

/** The number of the value that is nearest to another, among values that only ever rise, or fall. */
function nearest(values, wanted) {
  const rises = values.at(-1) >= values[0];
  let [low, high] = [0, values.length - 1];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (values[middle] <= wanted === rises) low = middle;
    else high = middle;
  }
  return Math.abs(values[high] - wanted) < Math.abs(values[low] - wanted) ? high : low;
}
