// Section maps: a force along a link over the whole cycle, its peak marked. What is negative is hatched too.

class Heat {
  constructor(section, force) {
    this.section = section;
    this.force = force;
    this.x = curveOf(alongInstants);
    this.sheet = new Sheet("map", `${section.link}: ${force.what} over the cycle and along the link`, {
      hover: (event) => this.hover(event),
      press: (event) => {
        const at = this.under(event);
        seekTo(at?.instant);
        if (at) this.pin?.({ section, ratio: at.ratio });
      },
    });
  }

  draw(width) {
    const height = 244;
    this.across = scaled(endsOf([this.x.values], false), [FIELD.left, width - FIELD.right - 58], this.x.unit, this.x.title);
    this.up = scaled([0, 1], [height - FIELD.bottom, FIELD.top], "1", "");
    const { across, up, section, force } = this;
    const peak = rowByName.get(`section:${section.link}:${force.name}`)?.peak;
    this.most = Math.abs(peak?.value ?? 0) || 1;
    const scale = scaleFor(force.unit, this.most);
    const field = { x: across.from, y: up.to, width: across.to - across.from, height: up.from - up.to };
    const picture = this.picture(Math.max(2, Math.round(field.width)), Math.round(field.height));
    this.sheet.fill(
      width, height,
      drawn("image", { ...field, href: picture, preserveAspectRatio: "none" }),
      axesOf(across, up),
      drawn("text", { x: 14, y: (up.from + up.to) / 2, class: "label", transform: `rotate(-90 14 ${(up.from + up.to) / 2})` }, "ξ/l, base to tip"),
      drawn("text", { x: (across.from + across.to) / 2, y: height - 6, class: "label" }, across.label),
      ...this.key(scale, width - FIELD.right - 44, up),
      ...(peak ? this.peakMark(peak, scale) : []),
    );
    this.mark(player.instant);
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

  /** The bar of colours with its ends. */
  key(scale, x, up) {
    const least = signed(this.force) ? -this.most : 0;
    const canvas = element("canvas", { width: 12, height: 120 });
    const context = canvas.getContext("2d");
    const image = context.createImageData(12, 120);
    const { colours } = this;
    for (let row = 0; row < 120; row += 1) {
      const value = this.most + (row / 119) * (least - this.most);
      for (let column = 0; column < 12; column += 1) paintPoint(image, column, row, value, this.most, colours);
    }
    context.putImageData(image, 0, 0);
    const text = (value, y) => drawn("text", { x: x + 6, y, class: "key" }, `${format(value * scale.factor, 3)}`);
    return [
      drawn("image", { x, y: up.to + 16, width: 12, height: up.from - up.to - 46, href: canvas.toDataURL(), preserveAspectRatio: "none" }),
      text(this.most, up.to + 9), text(least, up.from - 18), drawn("text", { x: x + 6, y: up.from - 2, class: "key" }, scale.unit),
    ];
  }

  /** The colours that the page has now; the stage reads all of them at once. */
  get colours() {
    const rgb = (text) => [1, 3, 5].map((k) => parseInt(text.slice(k, k + 2), 16));
    const { inks } = deck.stage.paper;
    return { positive: rgb(inks["map-positive"]), negative: rgb(inks["map-negative"]), none: rgb(inks["map-none"]) };
  }

  picture(width, height) {
    const { section, force } = this;
    const columns = Math.min(width, Math.max(instants.count, 2), live.moving ? 160 : 700);
    const rows = section.xi.length;
    const wide = columns < 240 && !live.moving ? 2 * columns : columns;
    const high = live.moving ? 51 : 2 * rows;
    const canvas = element("canvas", { width: wide, height: high });
    const context = canvas.getContext("2d");
    const image = context.createImageData(wide, high);
    const { colours } = this;
    let seen = 0;
    const values = new Float64Array(rows);
    let known = -1;
    for (let column = 0; column < wide; column += 1) {
      const x = this.across.back(this.across.from + ((column + 0.5) / wide) * (this.across.to - this.across.from));
      if (over) seen = nearest(this.x.values, x, seen);
      else seen = instantAt(x);
      if (seen !== known) {
        for (let row = 0; row < high; row += 1) {
          const at = Math.round((row / (high - 1)) * (rows - 1));
          values[at] = sectionForce(section, force.name, seen, at);
        }
        known = seen;
      }
      for (let row = 0; row < high; row += 1) {
        const at = Math.round(((high - 1 - row) / (high - 1)) * (rows - 1));
        paintPoint(image, column, row, values[at], this.most, colours);
      }
    }
    context.putImageData(image, 0, 0);
    return canvas.toDataURL();
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
    const instant = over ? nearest(this.x.values, x, 0) : instantAt(x);
    return { instant, ratio: Math.round(Math.max(0, Math.min(1, up.back(py))) * (this.section.xi.length - 1)) };
  }

  hover(event) {
    const at = event && this.under(event);
    if (!at) {
      showTip(null);
      return;
    }
    const { section } = this;
    showTip(event, `${section.link} at ξ/l = ${format(section.xi[at.ratio], 3)}; ${whenIs(at.instant)}`, sectionLines(section, at.ratio, at.instant));
  }
}

/** The instant whose value is nearest to one. */
function nearest(values, value, from) {
  let [best, away] = [from, Infinity];
  for (let i = 0; i < values.length; i += 1) {
    const d = Math.abs(values[i] - value);
    if (d < away) [best, away] = [i, d];
  }
  return best;
}

/** A point of a map: from nothing to positive or negative; what is negative has slanted darker lines. */
function paintPoint(image, column, row, value, most, { positive, negative, none }) {
  const part = Math.min(1, Math.abs(value) / most) ** 0.85;
  const to = value < 0 ? negative : positive;
  const lined = value < 0 && part > 0.04 && (column + row) % 8 < 1 ? 0.78 : 1;
  const at = 4 * (row * image.width + column);
  for (let k = 0; k < 3; k += 1) image.data[at + k] = (none[k] + part * (to[k] - none[k])) * lined;
  image.data[at + 3] = Number.isFinite(value) ? 255 : 0;
}
