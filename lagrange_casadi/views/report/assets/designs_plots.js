// Plots of designs: a map of a column over two parameters, or a curve over one; and two columns against each other, with their front.

const SPOT = 3.2;

/** A plot in which each design that is shown has a spot; `plot.spots` are [across, down, row]. */
class DesignPlot {
  constructor(kind, words) {
    this.sheet = new Sheet(kind, words, this);
    this.spots = [];
  }

  /** The number of the spot under the pointer. */
  under(event) {
    const [px, py] = this.sheet.at(event);
    return closest(this.spots.length, (k) => Math.hypot(this.spots[k][0] - px, this.spots[k][1] - py), 30);
  }

  press(spot) {
    pick(this.spots[spot][2]);
  }

  describe(spot) {
    const [, , row] = this.spots[spot];
    return [designWords(row), status[row] ? [["no result", contents.statuses[status[row]]]] : this.described.map((column) => [column.title, columnWords(column, row)])];
  }

  mark() {
    const spot = this.spots.find(([, , row]) => row === picked.row);
    this.sheet.cursor.replaceChildren(...(spot ? [drawn("circle", { cx: spot[0], cy: spot[1], r: 7, class: "of-0 looked" })] : []));
  }
}

/** A column over two parameters: as cells where designs are a grid, with other parameters as in the design that is looked at. */
class DesignMap extends DesignPlot {
  constructor(column, x, y) {
    super("map", `${column.title} over ${x.name} and ${y.name}`);
    Object.assign(this, { column, x, y, described: [column] });
  }

  draw(width) {
    const height = 300;
    const others = contents.designs.grid ? contents.parameters.filter((one) => one.name !== this.x.name && one.name !== this.y.name).map((one) => columnOf.get(one.name)) : [];
    const rows = picked.met.filter((row) => others.every((one) => picked.row < 0 || one.values[row] === one.values[picked.row]));
    const places = [this.x, this.y].map((one) => [...new Set(rows.map((row) => one.values[row]))].sort((a, b) => a - b));
    const cells = contents.designs.grid;
    const field = { left: FIELD.left, right: width - FIELD.right - 62, top: FIELD.top, bottom: height - FIELD.bottom };
    const scales = [[this.x, places[0], field.left, field.right], [this.y, places[1], field.bottom, field.top]].map(([one, at, from, to]) => (cells ? cellsOf(one, at, from, to) : scaled(endsOf(at), [from, to], one.unit, one.name, 0.04)));
    const values = rows.filter((row) => status[row] === 0).map((row) => costOf(this.column, row)).filter(Number.isFinite);
    const [low, high] = endsOf(values);
    const part = (row) => (high > low ? (costOf(this.column, row) - low) / (high - low) : 0.5);
    this.spots = rows.map((row) => [scales[0].at(this.x.values[row]), scales[1].at(this.y.values[row]), row]);
    const [across, up] = cells ? [scales[0].step, scales[1].step] : [0, 0];
    const shapes = this.spots.map(([x, y, row]) => {
      const known = status[row] === 0 && Number.isFinite(costOf(this.column, row));
      const style = known ? `fill: color-mix(in oklab, var(--map-positive) ${(8 + 92 * part(row)).toFixed(1)}%, var(--map-none))` : "fill: none; stroke: var(--line)";
      return cells ? drawn("rect", { x: x - across / 2, y: y - up / 2, width: across + 0.4, height: up + 0.4, style }) : drawn("circle", { cx: x, cy: y, r: SPOT + 1, style });
    });
    this.sheet.fill(width, height, axesOf(scales[0], scales[1]), ...shapes,
      ...[0, 1, 2, 3, 4, 5, 6, 7].map((k) => drawn("rect", { x: width - FIELD.right - 36, y: field.top + 20 + (k * (field.bottom - field.top - 52)) / 8, width: 12, height: (field.bottom - field.top - 52) / 8 + 0.5, style: `fill: color-mix(in oklab, var(--map-positive) ${8 + (92 * (7 - k)) / 7}%, var(--map-none))` })),
      ...keyOf(scaleFor(this.column.unit, high), width - FIELD.right - 30, scales[1], low, high));
    this.mark();
  }
}

/** A scale of cells of one size, in the order of the values that there are. */
function cellsOf(column, values, from, to) {
  const step = (to - from) / Math.max(values.length, 1);
  const place = new Map(values.map((value, k) => [value, from + (k + 0.5) * step]));
  const { factor, unit } = scaleFor(column.unit, largestOf(values));
  const stride = Math.max(1, Math.ceil(values.length / Math.max(2, Math.floor(Math.abs(to - from) / 62))));
  const ticks = values.map((value, k) => [place.get(value), value * factor, k]).filter(([, , k]) => k % stride === 0);
  return { at: (value) => place.get(value), step: Math.abs(step), ticks, describe: (tick) => format(tick, 4), title: column.name, label: labelled(column.name, unit), from, to };
}

/** Two columns against each other: all designs faint, those that no other beats in both strong and joined. */
class DesignFront extends DesignPlot {
  constructor(x, y) {
    super("curves", `${y.title} against ${x.title}`);
    Object.assign(this, { x, y, described: [x, y] });
  }

  draw(width) {
    const height = 280;
    const rows = comparable(this.x, this.y);
    const ends = [this.x, this.y].map((one) => endsOf(rows.map((row) => costOf(one, row))));
    const words = (one) => (one.sized ? `size of ${one.title}` : one.title);
    const across = scaled(ends[0], [FIELD.left, width - FIELD.right], this.x.unit, words(this.x), 0.04);
    const up = scaled(ends[1], [height - FIELD.bottom, FIELD.top], this.y.unit, "", 0.04);
    const at = (row) => [across.at(costOf(this.x, row)), up.at(costOf(this.y, row)), row];
    const front = frontOf(this.x, this.y);
    const best = new Set(front);
    this.spots = [...rows.filter((row) => !best.has(row)), ...front].map(at);
    const dots = this.spots.map(([cx, cy, row]) => drawn("circle", { cx, cy, r: best.has(row) ? SPOT + 0.8 : SPOT - 0.8, class: best.has(row) ? "best" : "dot" }));
    const steps = front.map(at).map(([x, y], k) => (k ? `H${x.toFixed(1)}V${y.toFixed(1)}` : `M${x.toFixed(1)} ${y.toFixed(1)}`)).join("");
    this.sheet.fill(width, height, axesOf(across, up), ...(steps ? [drawn("path", { d: steps, class: "front" })] : []), ...dots,
      drawn("text", { x: FIELD.left + 6, y: FIELD.top - 7, class: "aside" }, words(this.y)));
    this.mark();
  }
}
