// Maps along links: a section force, a stress or a deflection over the whole cycle, its peak marked. What is negative is hatched too.

/** What a map shows of a section force: its values at an instant, in words too, and where it is largest. */
function fieldOfForce(section, force) {
  const row = rowByName.get(`section:${section.link}:${force.name}`);
  return {
    link: section.link, what: force.what, unit: force.unit, signed: signed(force), xi: section.xi, where: "",
    nothing: () => Boolean(row) && isNothing(row),
    peak: () => (!row || row.open ? null : row.peak),
    column: instantOn,
    fill: (column, found, step) => (row && isNothing(row) ? found.fill(0) : sectionForces(section, force.name, column, found, step)),
    describe: (column, ratio) => [whenIs(column), sectionLines({ link: section.link, ratio }, column)],
    show: () => showRow(row),
  };
}

/** The same of a map whose numbers the page holds, at some of the instants. It is of the design of the file alone. */
function fieldOfMap(map) {
  const [t, xi, values, places] = [array(map.t), array(map.xi), array(map.values), array(over ? map.over : map.t)];
  const at = (column) => values.subarray(column * xi.length, (column + 1) * xi.length);
  return {
    link: map.link, what: map.what, unit: map.unit, signed: map.signed, xi, where: map.where, ofFile: true,
    nothing: () => false,
    peak: () => map.peak,
    column: (place) => nearest(places, place),
    fill: (column, found) => found.set(at(column)),
    describe: (column, ratio) => [whenOf(t[column], over ? places[column] : null), [[map.what, shown(at(column)[ratio], map.unit)]]],
    show: () => {
      seekTo(instantAt(map.peak.t));
      showSection(map.link, map.peak.xi);
      announce(`${map.link}: ${map.what} ${shown(map.peak.value, map.unit)}, ${whenOf(map.peak.t, map.peak.over)}`);
    },
  };
}

class Heat {
  constructor(field) {
    this.field = field;
    this.x = curveOf(alongInstants);
    this.values = new Float64Array(field.xi.length);
    this.sheet = new Sheet("map", `${field.link}: ${field.what} over the cycle and along the link`, this);
    this.canvas = element("canvas", { class: "heat", "aria-hidden": "true" });
    this.context = this.canvas.getContext("2d");
    this.marks = drawn("g");
    this.sheet.body.prepend(this.canvas);
  }

  draw(width) {
    const height = 244;
    this.across = scaled(endsOf(this.x.values), [FIELD.left, width - FIELD.right - 58], this.x.unit, this.x.title);
    this.up = scaled([0, 1], [height - FIELD.bottom, FIELD.top], "1", "ξ/l, base to tip");
    const { across, up } = this;
    const place = { x: across.from, y: up.to, width: across.to - across.from, height: up.from - up.to };
    // On the sheet it keeps its place at every size, as the drawing around it does.
    const parts = { left: place.x / width, top: place.y / height, width: place.width / width, height: place.height / height };
    for (const [side, part] of Object.entries(parts)) this.canvas.style[side] = `${100 * part}%`;
    this.sheet.fill(
      width, height,
      axesOf(across, up),
      drawn("image", { x: width - FIELD.right - 44, y: up.to + 16, width: 12, height: up.from - up.to - 46, href: barOf(coloursNow(), this.field.signed), preserveAspectRatio: "none" }),
      this.marks,
    );
    this.paint();
    this.mark(player.instant);
  }

  /** Take what the arrays hold now. */
  follow(width) {
    const ends = endsOf(this.x.values);
    if (width !== this.sheet.width || ends[0] !== this.across.low || ends[1] !== this.across.high) this.draw(width);
    else this.paint();
  }

  /** Write the ends of the colours, and where the force is largest. */
  markEnds() {
    const { field, up } = this;
    const peak = field.nothing() ? null : field.peak();
    this.most = Math.abs(peak?.value ?? 0) || 1;
    const scale = scaleFor(field.unit, this.most);
    this.marks.replaceChildren(...keyOf(scale, this.sheet.width - FIELD.right - 38, up, this.field.signed ? -this.most : 0, this.most), ...(peak ? this.peakMark(peak, scale) : []));
  }

  /** Where and when it is largest, as a button that shows it. */
  described() {
    const { field } = this;
    const peak = field.peak();
    if (!peak || !Number.isFinite(peak.value)) return [];
    if (field.nothing()) return [element("li", {}, "it is 0")];
    const words = `largest: ${shown(peak.value, field.unit)} at ξ/l = ${format(peak.xi, 3)}, ${whenOf(peak.t, peak.over)}${field.where ? `, ${field.where}` : ""}`;
    return [element("li", {}, element("button", { type: "button", class: "peak-button", title: "Show when and where", click: field.show }, words))];
  }

  peakMark(peak, scale) {
    const [x, y] = [this.across.at(over ? peak.over : peak.t), this.up.at(peak.xi)];
    const right = x < (this.across.from + this.across.to) / 2;
    const low = Math.max(FIELD.top + 16, Math.min(y + (peak.xi > 0.5 ? 18 : -10), this.up.from - 6));
    const words = `${format(peak.value * scale.factor, 4)} ${scale.unit}`;
    return [
      drawn("path", { d: `M${x - 7} ${y}H${x + 7}M${x} ${y - 7}V${y + 7}`, class: "peak" }),
      drawn("text", { x: x + (right ? 10 : -10), y: low, class: `peak-text ${right ? "" : "end"}` }, words),
    ];
  }

  /** Paint the map, with its marks; a coarse one while a slider moves. */
  paint() {
    this.markEnds();
    const { field, canvas, context, values, across } = this;
    const width = Math.max(2, Math.round(across.to - across.from));
    const rows = field.xi.length;
    const step = live.moving ? 2 : 1;
    const columns = Math.min(width, Math.max(instants.count, 2), live.moving ? 140 : 700);
    const wide = columns < 240 && !live.moving ? 2 * columns : columns;
    const high = live.moving ? Math.ceil(rows / 2) : 2 * rows;
    if (canvas.width !== wide || canvas.height !== high) {
      [canvas.width, canvas.height] = [wide, high];
      this.image = context.createImageData(wide, high);
    }
    const pixels = new Uint32Array(this.image.data.buffer);
    const colours = coloursNow();
    const places = Array.from({ length: high }, (_, row) => step * Math.round(((high - 1 - row) / (high - 1)) * ((rows - 1) / step)));
    let known = -1;
    for (let column = 0; column < wide; column += 1) {
      const seen = field.column(across.low + ((column + 0.5) / wide) * (across.high - across.low));
      if (seen !== known) field.fill(seen, values, step);
      known = seen;
      for (let row = 0; row < high; row += 1) pixels[row * wide + column] = pixelOf(values[places[row]] / this.most, column + row, colours);
    }
    context.putImageData(this.image, 0, 0);
  }

  /** What is saved as CSV: a row an instant, a column a ratio xi/l. */
  table() {
    const { field, x } = this;
    const found = new Float64Array(field.xi.length);
    const rows = Array.from(x.values, (value) => {
      found.fill(0);
      field.fill(field.column(value), found, 1);
      return [value, ...found];
    });
    return { heads: [headOfCurve(x), ...Array.from(field.xi, (xi) => `${field.what} [${field.unit}] at xi/l = ${Number(xi.toFixed(6))}`)], rows };
  }

  mark(instant) {
    const x = this.across.at(this.x.values[instant]);
    this.sheet.cursor.replaceChildren(drawn("line", { class: "cursor-line", x1: x, x2: x, y1: this.up.to, y2: this.up.from }));
  }

  under(event) {
    const [px, py] = this.sheet.at(event);
    const { across, up } = this;
    if (px < across.from || px > across.to || py < up.to || py > up.from) return null;
    const x = across.back(px);
    return { instant: instantOn(x), x, xi: Math.max(0, Math.min(1, up.back(py))) };
  }

  press({ instant, xi }) {
    seekTo(instant);
    showSection(this.field.link, xi);
  }

  describe({ x, xi }) {
    const { field } = this;
    const ratio = Math.round(xi * (field.xi.length - 1));
    const [when, lines] = field.describe(field.column(x), ratio);
    return [`${field.link} at ξ/l = ${format(field.xi[ratio], 3)}; ${when}`, lines];
  }
}

const LEVELS = 255;

/** The points of a map in the colours that the page has now: `plain` and `lined` have one for each level, from all negative to all positive. */
function coloursNow() {
  const { inks } = deck.stage.paper;
  return (inks.levels ??= levelsOf(...["map-positive", "map-negative", "map-none"].map((name) => partsOfInk(inks[name]))));
}

function levelsOf(positive, negative, none) {
  const point = (level, dark) => {
    const part = (Math.abs(level) / LEVELS) ** 0.85;
    const to = level < 0 ? negative : positive;
    const light = dark && level < 0 && part > 0.04 ? 0.78 : 1;
    const [r, g, b] = [0, 1, 2].map((k) => Math.round((none[k] + part * (to[k] - none[k])) * light));
    return ((255 << 24) | (b << 16) | (g << 8) | r) >>> 0;
  };
  const all = (dark) => Uint32Array.from({ length: 2 * LEVELS + 1 }, (_, k) => point(k - LEVELS, dark));
  return { plain: all(false), lined: all(true) };
}

/** A point of a map, by its part of the largest value: from nothing to positive or negative; what is negative has slanted darker lines. */
function pixelOf(part, slant, { plain, lined }) {
  if (!Number.isFinite(part)) return 0;
  const level = LEVELS + Math.round(LEVELS * Math.max(-1, Math.min(1, part)));
  return (slant % 8 ? plain : lined)[level];
}

/** The bar of colours beside a map, from the largest value to its negative or to nothing, as the address of a picture. */
function barOf(colours, both) {
  const canvas = element("canvas", { width: 12, height: 120 });
  const context = canvas.getContext("2d");
  const image = context.createImageData(12, 120);
  const pixels = new Uint32Array(image.data.buffer);
  for (let row = 0; row < 120; row += 1) {
    for (let column = 0; column < 12; column += 1) pixels[12 * row + column] = pixelOf(1 - ((both ? 2 : 1) * row) / 119, column + row, colours);
  }
  context.putImageData(image, 0, 0);
  return canvas.toDataURL();
}
