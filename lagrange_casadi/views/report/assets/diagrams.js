// Axial force, shear force and bending moment along a link, as textbooks draw them: below each other, with values at ends and peaks.

/** The row whose instant governs a link: of the largest stress, else of the bending moment, or of the axial force where nothing bends it. */
function governing(link) {
  const rows = [`stress:${link}:von_mises`, `section:${link}:bending`, `section:${link}:axial`].map((name) => rowByName.get(name));
  const known = rows.filter((row) => row && !row.open);
  return known.find((row) => !isNothing(row)) ?? known[0] ?? null;
}

/** The links that have diagrams. */
function diagramLinks() {
  return sections.filter((section) => knownForces(section).some(signed) && governing(section.link));
}

/** Values of a force that are written: at ends, on both sides of jumps, and where it turns; the largest first, those of ends next. */
function marksOf({ ratios, values }) {
  const last = ratios.length - 1;
  const least = 1e-6 * largestOf(values);
  const jumps = (k) => k > 0 && k <= last && ratios[k] === ratios[k - 1] && Math.abs(values[k] - values[k - 1]) > least;
  const found = [];
  for (let k = 0; k <= last; k += 1) {
    const tip = jumps(k);
    const jump = tip || jumps(k + 1);
    if (k === 0 || k === last || jump) {
      found.push({ xi: ratios[k], value: values[k], anchor: jump ? (tip ? "start" : "end") : "middle" });
      continue;
    }
    // Of two points at one place that do not jump the second stands for both.
    if (ratios[k] === ratios[k + 1]) continue;
    const [a, b, c] = [values[k - (ratios[k] === ratios[k - 1] ? 2 : 1)], values[k], values[k + 1]];
    if ((b - a) * (c - b) >= 0) continue;
    // The parabola through three points, evenly apart but beside a jump.
    const h = ratios[k + 1] - ratios[k];
    const [slope, bend] = [(c - a) / 2, a - 2 * b + c];
    const even = Math.abs(ratios[k] - ratios[k - 1] - h) < 1e-9;
    found.push(even ? { xi: ratios[k] - (h * slope) / bend, value: b - (slope * slope) / (2 * bend), anchor: "middle" } : { xi: ratios[k], value: b, anchor: "middle" });
  }
  const size = (mark) => Math.abs(mark.value);
  const ends = found.filter((mark) => mark.xi === 0 || mark.xi === 1);
  found.sort((a, b) => size(b) - size(a));
  return [...new Set([found[0], ...ends.filter((mark) => mark.value), ...found])].filter((mark) => mark.value || ends.includes(mark));
}

class Diagram {
  follow = this.draw;

  constructor(section, when) {
    Object.assign(this, { section, middle: when === "shown" });
    this.forces = knownForces(section).filter(signed);
    this.sheet = new Sheet("diagram", `${section.link}: ${this.forces.map((force) => force.what).join(", ")} along the link`, this);
  }

  get instant() {
    return this.middle ? player.instant : instantAt(governing(this.section.link).peak.t);
  }

  /** A force along the link; the rounding of nothing is nothing. */
  along(force) {
    const row = rowByName.get(`section:${this.section.link}:${force.name}`);
    const found = forceAlong(this.section, force.name, this.instant, 1);
    const most = row && isNothing(row) ? Infinity : largestOf(found.values);
    return { ratios: found.ratios, values: found.values.map((value) => (Math.abs(value) <= ROUNDING * most ? 0 : value)) };
  }

  draw(width) {
    const [from, to, half] = [FIELD.left - 14, width - 46, 28];
    const across = (xi) => from + xi * (to - from);
    this.across = { from, to };
    const parts = [];
    let top = 4;
    for (const force of this.forces) {
      // Below its name a force has room for numbers, and on the sides of the link on which it is.
      const along = this.along(force);
      const [up, down] = [1, -1].map((sign) => (along.values.some((value) => sign * value > 0) ? half : 0));
      const name = labelled(force.what, scaleFor(force.unit, largestOf(along.values)).unit);
      parts.push(drawn("text", { x: 4, y: top + 11, class: "name" }, name), ...this.panel(force, along, top + 29 + up, half, across));
      top += 48 + up + down;
    }
    this.sheet.fill(width, top + 14, ...parts, drawn("text", { x: from, y: top + 10, class: "x" }, "base"), drawn("text", { x: to, y: top + 10, class: "x" }, "tip"));
  }

  panel(force, { ratios, values }, y0, half, across) {
    const most = largestOf(values);
    const { factor } = scaleFor(force.unit, most);
    const at = (value) => y0 - (most ? (half * value) / most : 0);
    const path = (sign) => `M${across(0)} ${y0}${values.map((value, k) => `L${across(ratios[k])} ${at(sign * value > 0 ? value : 0)}`).join("")}L${across(1)} ${y0}Z`;
    const sides = [[1, "positive"], [-1, "negative"]].filter(([sign]) => values.some((value) => sign * value > 0));
    const parts = [
      ...sides.map(([sign, kind]) => drawn("path", { d: path(sign), class: `area ${kind}` })),
      drawn("path", { d: `M${across(0)} ${y0}${values.map((value, k) => `L${across(ratios[k])} ${at(value)}`).join("")}L${across(1)} ${y0}`, class: "outline" }),
      drawn("line", { x1: across(0), x2: across(1), y1: y0, y2: y0, class: "beam" }),
    ];
    if (!most) return [...parts, drawn("text", { x: across(0.5), y: y0 - 5, class: "x" }, "0")];
    const taken = [];
    for (const mark of marksOf({ ratios, values })) {
      const [x, y, up] = [across(mark.xi), at(mark.value), mark.value >= 0];
      const hidden = (one) => one.up === up && Math.abs(one.x - x) < (one.x === x ? 0 : 52) && Math.abs(one.y - y) < 13;
      if (taken.some(hidden)) continue;
      taken.push({ x, y, up });
      const beside = { start: 3, end: -3, middle: 0 }[mark.anchor];
      parts.push(drawn("text", { x: x + beside, y: y + (up ? -4 : 13), class: "value", "text-anchor": mark.anchor }, format(mark.value * factor, 4)));
    }
    return parts;
  }

  mark() {
    if (this.middle) this.draw(this.sheet.width);
  }

  /** At which instant, and why then. */
  described() {
    const row = governing(this.section.link);
    const words = this.middle ? "at the instant that is shown" : `at ${whenIs(this.instant)}: largest ${row.what}`;
    return [element("li", {}, words), element("li", {}, "action of the tip's side on the base's")];
  }

  /** The number of the ratio under the pointer. */
  under(event) {
    const { from, to } = this.across;
    return Math.round(Math.max(0, Math.min(1, (this.sheet.at(event)[0] - from) / (to - from))) * (this.section.xi.length - 1));
  }

  press() {
    seekTo(this.instant);
  }

  describe(ratio) {
    const place = { link: this.section.link, ratio };
    return [`${placeWords(place)}; ${whenIs(this.instant)}`, sectionLines(place, this.instant)];
  }

  /** What is saved as CSV. */
  table() {
    const all = this.forces.map((force) => this.along(force));
    const { ratios } = all[0];
    return { heads: ["xi/l", ...this.forces.map((force) => `section:${this.section.link}:${force.name} [${force.unit}]`)], rows: ratios.map((xi, k) => [xi, ...all.map(({ values }) => values[k])]) };
  }
}
