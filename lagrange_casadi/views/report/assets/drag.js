// Joints of a live page that are dragged: the parameters of their places follow the pointer, and all else follows the parameters.

const WITHIN = 14; // Points of the screen, from a joint to the pointer that takes it.

const STEP = 1e-5; // Of a parameter's range: half the difference by which a derivative is found.

const STILL = 0.1; // Points of the screen: what moves a joint no more than this in its whole range does not move the joint.

const DAMPING = 1e-3; // Of the squares of derivatives: what keeps a step small where a place hardly moves.

class Drag {
  constructor(engine, stage) {
    Object.assign(this, { engine, stage, joint: null, moving: false, pointer: null, before: null, posture: null });
    this.ranges = contents.parameters.map((one) => rangeOf(one));
    this.freed = contents.parameters.map(() => false);
    this.own = this.ownParameters();
  }

  /** For each joint, which parameters its place on its bodies is made of. */
  ownParameters() {
    const { values, numbers } = this.engine.file;
    const changed = Array.from(values, (_, n) => {
      const others = [-1, 1].map((way) => this.engine.numbers(this.beside(values, n, way)));
      return (place) => place >= 0 && others.some((other) => other[place] !== numbers[place]);
    });
    return this.engine.live.picture.joints.map(({ parent, child }) => changed.map((by) => [...parent, ...child].some(by)));
  }

  beside(values, n, way) {
    const [low, high] = this.ranges[n];
    return values.map((value, k) => (k === n ? value + way * STEP * (high - low) : value));
  }

  /** Mark the joint under the pointer whose place can follow, if there is one. */
  seek(pointer) {
    const { stage, joint } = this;
    const away = (one) => Math.hypot(...this.missOf(spotOf(one.child, stage.instant), pointer));
    const near = contents.joints.filter((one) => away(one) < WITHIN).sort((a, b) => away(a) - away(b));
    this.joint = near.find((one) => this.take(one)) ?? null;
    stage.paper.canvas.style.cursor = this.joint ? "move" : "";
    if (joint !== this.joint && !player.playing) stage.draw();
    return this.joint;
  }

  /** Take a joint, with the others at its place; returns whether a parameter moves it. One that has no parameters of its own follows all. */
  take(joint) {
    const { engine, stage } = this;
    this.spot = joint.child;
    const at = spotOf(joint.child, stage.instant);
    const near = (place) => sizeOf(less(place, at)) < 1e-6 * extent.size;
    const together = contents.joints.map((other) => near(spotOf(other.child, stage.instant)));
    const owned = contents.parameters.map((_, n) => this.own.some((own, k) => together[k] && own[n]));
    this.active = owned.map((is, n) => this.freed[n] || is || !owned.some(Boolean));
    const base = this.base();
    return Boolean(base) && near(this.placeOf(base)) && this.columns(base).some(([x, y]) => x || y);
  }

  /** The posture that is shown. */
  base() {
    const { engine, stage } = this;
    if (!engine.why) return engine.postures.near(stage.instant);
    engine.stand(stage.instant);
    return engine.stood.posture;
  }

  /** The place of the joint in a posture. */
  placeOf(posture) {
    const { spot, engine } = this;
    const own = contents.joints.findIndex((joint) => joint.child === spot);
    const at = engine.live.picture.joints[own].child.map((place) => (place < 0 ? 0 : posture.numbers[place]));
    return placeIn(spot.body === "ground" ? GROUND : engine.postures.frameOf(posture, spot.body), at);
  }

  missOf(place, pointer) {
    const [x, y] = this.stage.paper.on(place);
    return [pointer[0] - x, pointer[1] - y];
  }

  /** How far the joint moves on the sheet for the range of each parameter: a central difference, one-sided where there are no such parts. */
  columns(posture) {
    const { engine, stage } = this;
    const { values, instant, weights } = posture;
    return contents.parameters.map((_, n) => {
      if (!this.active[n]) return [0, 0];
      const sides = [-1, 1].map((way) => engine.postures.find(this.beside(values, n, way), instant, posture, weights));
      if (!sides.some(Boolean)) return [0, 0];
      const [back, on] = sides.map((side) => this.placeOf(side ?? posture));
      const way = stage.paper.along(times(less(on, back), 1 / (STEP * sides.filter(Boolean).length)));
      return Math.hypot(...way) > STILL ? way : [0, 0];
    });
  }

  /** The step of the parameters, over their ranges, that brings the joint nearest to the pointer within the bounds: the least of all such. */
  step(values, columns, miss) {
    const ends = contents.parameters.map(({ low, high }, n) => {
      const wide = this.ranges[n][1] - this.ranges[n][0];
      return [low === null ? -Infinity : (low - values[n]) / wide, high === null ? Infinity : (high - values[n]) / wide];
    });
    const found = columns.map(() => 0);
    const free = columns.map(([x, y]) => Boolean(x || y));
    let rest = miss;
    for (let left = free.filter(Boolean).length; left > 0; ) {
      const used = columns.map((column, n) => (free[n] ? column : [0, 0]));
      const product = ([x, y], [a, b]) => x * a + y * b;
      const asked = solved(used.map((column) => [...used.map((other) => product(column, other)), product(column, rest)]), DAMPING);
      const held = asked.map((value, n) => Math.max(ends[n][0], Math.min(ends[n][1], value)));
      const over = free.map((is, n) => is && held[n] !== asked[n]);
      if (!over.some(Boolean)) return found.map((value, n) => (free[n] ? asked[n] : value));
      // What would leave its bounds stays at their end, and the others go on from there.
      over.forEach((is, n) => {
        if (!is) return;
        [found[n], free[n], left] = [held[n], false, left - 1];
        rest = rest.map((value, k) => value - columns[n][k] * held[n]);
      });
    }
    return found;
  }

  /** The posture that brings the joint nearest to the pointer, by steps of Gauss and Newton that become shorter where they lead away. */
  nearest() {
    const { engine, pointer } = this;
    const [closed, missOf] = [engine.postures.near(this.stage.instant), (posture) => this.missOf(this.placeOf(posture), pointer)];
    let posture = this.posture;
    for (let k = 0; k < 8; k += 1) {
      const { values, instant } = posture;
      const miss = missOf(posture);
      const columns = this.columns(posture);
      const step = this.step(values, columns, miss);
      let next = null;
      for (let part = 1; part > 0.02; part /= 2) {
        const asked = values.map((value, n) => this.rounded(value + part * step[n] * (this.ranges[n][1] - this.ranges[n][0]), n, columns[n]));
        next = engine.postures.find(asked, instant, closed);
        if (next && Math.hypot(...missOf(next)) < Math.hypot(...miss)) break;
        next = null;
      }
      if (!next) break;
      posture = next;
    }
    return posture;
  }

  /** A value within its bounds, with digits as far as a tenth of a point of the screen. */
  rounded(value, n, column) {
    const { low, high } = contents.parameters[n];
    const size = Math.hypot(...column);
    if (!size) return value;
    const wide = (this.ranges[n][1] - this.ranges[n][0]) * Math.min(1, 100 / size);
    return Math.max(low ?? -Infinity, Math.min(high ?? Infinity, shortest(value, wide)));
  }

  start(pointer) {
    if (!this.seek(pointer)) return;
    player.pause();
    this.moving = true;
    this.before = [...this.engine.values];
    this.posture = this.base();
    const at = this.stage.paper.on(spotOf(this.spot, this.stage.instant));
    this.grip = [at[0] - pointer[0], at[1] - pointer[1]];
  }

  move(pointer) {
    this.pointer = [pointer[0] + this.grip[0], pointer[1] + this.grip[1]];
    // One design for each picture of the screen: what was asked for is shown first.
    if (!live.asked) ask(this.engine.values);
  }

  end() {
    if (!this.moving) return;
    this.moving = false;
    // What is asked for is still to be shown.
    if (!live.asked) this.pointer = null;
    settle();
  }

  /** Put the parameters back to where the last drag began, unless they were changed otherwise since. */
  undo() {
    if (!this.before) return false;
    [this.moving, this.pointer] = [false, null];
    setAll(this.before);
    return true;
  }

  /** Show the design that the pointer asks for. */
  show(whole) {
    const { engine } = this;
    this.posture = this.nearest();
    engine.show(this.posture.values, whole);
    if (!engine.why) engine.postures.last = { ...this.posture, values: engine.known };
    fillFields(engine.values);
    if (!this.moving) this.pointer = null;
  }

  /** The ring around a joint that can be dragged, and how far it stays behind the pointer. */
  draw(paper) {
    if (!this.joint) return;
    const [x, y] = paper.on(spotOf(this.joint.child, this.stage.instant));
    paper.put(ORDER.names, -1, (context) => {
      circleAround(context, x, y, pinSize(paper) + 5);
      strokeWith(context, paper.inks.accent, 2);
      if (!this.pointer) return;
      context.setLineDash([4, 4]);
      lineThrough(context, [[x, y], this.pointer]);
      strokeWith(context, paper.inks.accent, 1.5);
    });
  }
}
