// Charts: quantities over time, over a drive, or over one another, those of each unit in a field of their own.

class Chart {
  press = seekTo;

  point = (instant) => this.mark(instant, this.sheet.pointer);

  /** `x` is a curve, `curves` are those over it. Where x only ever rises, or falls, it is `ordered`, and an instant has one place on it. */
  constructor(x, curves) {
    this.x = x;
    this.curves = curves;
    this.sheet = new Sheet("curves", `${curves.map((curve) => curve.title).join("; ")}; over ${x.title}`, this);
    this.order();
  }

  order() {
    const { values } = this.x;
    this.ordered = [1, -1].some((way) => values.every((value, i) => i === 0 || way * value > way * values[i - 1]));
  }

  /** Take what the arrays hold now. Axes stay where they are while curves fit in: then what changes is seen, and little is to be drawn. */
  follow(width) {
    for (const curve of [this.x, ...this.curves]) curve.renew?.();
    if (this.x.name !== "t" && this.x.name !== "over") this.order();
    const { across, fields } = this;
    const ends = endsOf(this.x.values);
    const same = this.ordered ? ends[0] === across.low && ends[1] === across.high : fitsIn(ends, across);
    if (width !== this.sheet.width || !same || !fields.every(({ up, own }) => fitsIn(endsOf([0], ...own.map((curve) => curve.values)), up))) {
      this.draw(width);
      return;
    }
    for (const { up, own, lines } of fields) lines.forEach((line, k) => line.setAttribute("d", this.pathOf(own[k], up)));
  }

  pathOf(curve, up) {
    return pathOf(this.x.values, curve.values, this.across, up, this.ordered ? (live.moving ? 3 : 0.5) : 0);
  }

  draw(width) {
    const units = [...new Set(this.curves.map((curve) => curve.unit))];
    const high = units.length > 1 ? 0.8 * FIELD.height : FIELD.height * 1.15;
    const height = FIELD.top + units.length * high + (units.length - 1) * FIELD.between + FIELD.bottom;
    const across = scaled(endsOf(this.x.values), [FIELD.left, width - FIELD.right], this.x.unit, this.x.title, this.ordered ? 0 : 0.03);
    this.across = across;
    this.fields = units.map((unit, k) => {
      const top = FIELD.top + k * (high + FIELD.between);
      const own = this.curves.filter((curve) => curve.unit === unit);
      const ends = endsOf([0], ...own.map((curve) => curve.values));
      // The rounding of nothing is drawn as nothing.
      const nothing = Math.max(-ends[0], ends[1]) <= UNSEEN * (sizesOfUnits().get(unit) ?? 0);
      const up = scaled(nothing ? [0, 0] : ends, [top + high, top], unit, "", 0.06);
      return { up, own, top, bottom: top + high, lines: own.map((curve) => drawn("path", { d: this.pathOf(curve, up), ...lineOf(this.curves.indexOf(curve)) })) };
    });
    this.sheet.fill(
      width, height,
      ...this.fields.map(({ up }, k) => axesOf(across, up, k === this.fields.length - 1)),
      ...this.fields.flatMap(({ lines }) => lines),
    );
    this.mark(player.instant);
  }

  /** Mark an instant: a line where the axis has one place for it, and a dot on every curve. */
  mark(instant, group = this.sheet.cursor) {
    const x = this.across.at(this.x.values[instant]);
    const dots = this.fields.flatMap(({ up, own }) =>
      own
        .filter((curve) => Number.isFinite(curve.values[instant]))
        .map((curve) => drawn("circle", { cx: x, cy: up.at(curve.values[instant]), r: 3.6, class: `of-${this.curves.indexOf(curve) % BODY_COLOURS}` })),
    );
    const line = this.ordered ? [drawn("line", { x1: x, x2: x, y1: this.fields[0].top, y2: this.fields.at(-1).bottom })] : [];
    group.replaceChildren(...line, ...dots);
  }

  /** The instant under the pointer. */
  under(event) {
    const [px, py] = this.sheet.at(event);
    return closest(instants.count, (i) => {
      const dx = this.across.at(this.x.values[i]) - px;
      const dy = this.ordered ? 0 : Math.min(...this.fields.flatMap(({ up, own }) => own.map((curve) => Math.abs(up.at(curve.values[i]) - py))));
      return Math.hypot(dx, dy);
    });
  }

  describe(instant) {
    const lines = this.ordered ? [] : [[this.x.title, shown(this.x.values[instant], this.x.unit, 5, largestOf(this.x.values))]];
    const values = this.curves.map((curve) => {
      const value = shownOf(curve.values[instant], curve.unit, largestOf(curve.values));
      return [curve.title, curve.places ? `${value} at ξ/l = ${format(curve.places[instant], 3)}` : value];
    });
    return [whenIs(instant), [...lines, ...values]];
  }

  /** What is saved as CSV: of all instants that are shown, in SI. */
  table() {
    const curves = [this.x, ...this.curves];
    return { heads: curves.map(headOfCurve), rows: Array.from(this.x.values, (_, i) => curves.map((curve) => curve.values[i])) };
  }
}
