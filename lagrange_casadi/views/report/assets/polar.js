// Polar plots of what a joint bears: the way of the force's end, in ground axes or on a body, as a bearing or its pin sees it.

/** The plots that a joint offers: [value, words, pair of columns]. */
function polarWays(joint) {
  const column = (member) => seriesByName.get(`reaction:${joint.name}:${member}`);
  const pairs = contents.space ? [["fx", "fy"], ["fy", "fz"], ["fx", "fz"], ["fu", "fv"], ["fv", "fw"], ["fu", "fw"]] : [["fx", "fy"]];
  const found = pairs.filter((pair) => pair.every(column)).map((pair) => {
    const own = "uvw".includes(pair[0][1]);
    const words = contents.space ? `${pair.join(", ")} ${own ? "on the joint's own axes" : "in ground axes"}` : "in ground axes";
    return { words, pair, columns: pair.map((member) => array(column(member).values)), body: null };
  });
  if (contents.space || !found.length) return found;
  const along = [...new Set([joint.parent.body, joint.child.body])].filter((body) => body !== "ground" && bodies.get(body).kind !== "point");
  return [...found, ...along.map((body) => ({ ...found[0], pair: ["along", "across"], words: `on ${body}, along and across its axis`, body }))];
}

/** Joints whose reactions can be plotted. */
function polarJoints() {
  return contents.joints.filter((joint) => polarWays(joint).length);
}

class Polar {
  press = seekTo;

  point = (instant) => this.mark(instant, this.sheet.pointer);

  constructor(joint, way) {
    this.joint = joint;
    this.way = way;
    this.sheet = new Sheet("polar", `reaction of ${joint.name}, ${way.words}`, this);
    this.place();
  }

  place() {
    const { way } = this;
    this.points = Array.from({ length: instants.count }, (_, i) => {
      const [x, y] = [way.columns[0][i], way.columns[1][i]];
      if (!way.body) return [x, y];
      const [, e, n] = frameOf(way.body, i);
      return [x * e[0] + y * e[1], x * n[0] + y * n[1]];
    });
  }

  /** Take what the arrays hold now; the scale stays while the curve fits in. */
  follow(width) {
    this.place();
    const most = this.most();
    if (width !== this.sheet.width || !(most * this.scale <= this.reach && most * this.scale >= 0.5 * this.reach)) this.draw(width);
    else this.curve.setAttribute("d", this.path());
  }

  /** The largest force. */
  most() {
    return largestOf(this.points.map(([x, y]) => Math.sqrt(x * x + y * y))) || 1;
  }

  path() {
    const [xs, ys] = [0, 1].map((k) => this.points.map((point) => point[k]));
    const [x, y] = [1, -1].map((way, k) => ({ low: 0, high: 1, from: this.middle[k], to: this.middle[k] + way * this.scale }));
    return pathOf(xs, ys, x, y);
  }

  draw(width) {
    const side = Math.min(width, 380);
    const half = side / 2;
    this.middle = [width / 2, half];
    const most = this.most();
    const { factor, unit } = scaleFor("N", most);
    this.reach = half - 30;
    this.scale = this.reach / most;
    const rings = ticksBetween(0, most * factor, 3).filter((tick) => tick > 0).map((tick) => [((tick / factor) * this.scale), tick]);
    const [cx, cy] = this.middle;
    const [right, up] = this.way.pair;
    this.curve = drawn("path", { d: this.path(), class: "curve of-0" });
    this.sheet.fill(
      width, side,
      drawn("g", { class: "axes" },
        rings.map(([r]) => drawn("circle", { cx, cy, r, class: "net" })),
        drawn("line", { x1: cx - half + 22, x2: cx + half - 22, y1: cy, y2: cy, class: "zero" }),
        drawn("line", { x1: cx, x2: cx, y1: 22, y2: side - 22, class: "zero" }),
        rings.map(([r, tick], k) => drawn("text", { x: cx + 0.707 * r + 3, y: cy - 0.707 * r - 3, class: "ring" }, `${format(tick, 3)}${k === rings.length - 1 ? ` ${unit}` : ""}`)),
        drawn("text", { x: cx + half - 18, y: cy + 4, class: "ring" }, right),
        drawn("text", { x: cx, y: 16, class: "x" }, up)),
      this.curve,
    );
    this.mark(player.instant);
  }

  /** What is saved as CSV. */
  table() {
    const x = curveOf(alongInstants);
    return { heads: [headOfCurve(x), ...this.way.pair.map((one) => `reaction:${this.joint.name}, ${one} [N]`)], rows: this.points.map((point, i) => [x.values[i], ...point]) };
  }

  mark(instant, group = this.sheet.cursor) {
    const [x, y] = this.points[instant];
    const [cx, cy] = this.middle;
    const [px, py] = [cx + x * this.scale, cy - y * this.scale];
    group.replaceChildren(drawn("line", { x1: cx, y1: cy, x2: px, y2: py, class: "arm" }), drawn("circle", { cx: px, cy: py, r: 4, class: "of-0" }));
  }

  /** The instant under the pointer. */
  under(event) {
    const [at, down] = this.sheet.at(event);
    const [px, py] = [at - this.middle[0], this.middle[1] - down];
    return closest(instants.count, (i) => Math.hypot(this.points[i][0] * this.scale - px, this.points[i][1] * this.scale - py));
  }

  describe(instant) {
    const [x, y] = this.points[instant];
    const most = this.most();
    const described = (value) => shownOf(value, "N", most);
    const turn = ((Math.atan2(y, x) * 180) / Math.PI).toFixed(1);
    const [right, up] = this.way.pair;
    return [whenIs(instant), [[right, described(x)], [up, described(y)], ["size", described(Math.hypot(x, y))], ["direction", `${minus(turn)} deg`]]];
  }
}
