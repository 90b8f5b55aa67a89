// The picture of the mechanism: everything that is drawn of an instant, and what is chosen to be drawn.

const ROUND = [1, 2, 5, 10]; // Times a power of ten: distances of nets, and lengths of bars.

const LONGEST = 0.2; // The longest arrow or ordinate, over the mechanism's size.

class Stage {
  constructor(canvas) {
    this.paper = new Paper(canvas);
    this.instant = 0;
    const bending = ribbonForces.find((force) => force.name === "bending") ?? ribbonForces[0];
    this.shows = { reaction: true, effort: true, load: true, ribbon: bending?.name ?? "", names: true, traces: true, ways: false, values: false, size: 1 };
    this.controls = {};
    this.beside = {};
    this.pinned = null;
    this.pointed = null;
    this.touched = false;
    this.measure();
    this.ends = arrowEnds(this.shows, this.scale);
    this.trace();
    for (const act of ["view", "fit", "show", "zoom", "pan", "orbit"]) this[act] = shared(act, this[act].bind(this));
    acts.agree = this.agree.bind(this);
  }

  /** Find the scales anew, for what is shown now: with another picture beside this one, scales at which both have room. */
  measure() {
    const [force, moment] = [false, true].map((turning) => largestAction(this.shows, turning));
    const most = largestOf(sections.map(({ link }) => rowByName.get(`section:${link}:${this.shows.ribbon}`)?.peak?.value ?? 0));
    const full = LONGEST * extent.size * this.shows.size;
    this.wanted = {
      force: force ? full / force : 0,
      // In the plane a moment sweeps part of a turn; in space it is an arrow of a length.
      moment: moment ? (contents.space ? full : Math.min(1, this.shows.size)) / moment : 0,
      ribbon: most ? full / most : 0,
    };
    this.scale = Object.fromEntries(Object.entries(this.wanted).map(([kind, scale]) => [kind, Math.min(scale, this.beside[kind] || Infinity)]));
  }

  /** Have the whole mechanism on the sheet; with another picture beside this one, at the scale of the larger mechanism. */
  place() {
    this.reach = this.paper.fit(this.ends, this.beside.reach);
    this.askFor();
  }

  /** Ask the picture beside this one for the scales that this one wants, where they are others than before. */
  askFor() {
    const wanted = JSON.stringify({ ...this.wanted, reach: this.reach });
    if (wanted !== this.asked) post("agree", [JSON.parse(wanted)]);
    this.asked = wanted;
  }

  /** Take the scales that the picture beside this one wants. */
  agree(beside) {
    // What this one asked for before may have come before the other one could hear it.
    if (!this.beside.reach) this.asked = null;
    this.beside = beside;
    this.renew();
  }

  /** Follow the points whose ways are shown, for the motion that there is now. */
  trace() {
    this.traces = tracesNow(this.shows);
  }

  layOut() {
    this.paper.readInks();
    this.paper.resize();
    if (!this.touched) this.place();
    this.draw();
  }

  /** Look from somewhere, with all on the sheet. */
  view(azimuth, elevation) {
    this.paper.turnTo(azimuth, elevation);
    this.fit();
  }

  fit() {
    this.touched = false;
    this.place();
    this.draw();
  }

  /** Have all larger by a factor about a point of the sheet, by default its middle. */
  zoom(factor, [x, y] = [this.paper.width / 2, this.paper.height / 2]) {
    const { camera, width, height } = this.paper;
    const before = camera.scale;
    camera.scale = Math.max(1e-6, Math.min(1e9, before * factor));
    const from = [x - width / 2, y - height / 2];
    camera.shift = from.map((at, k) => at - (camera.scale / before) * (at - camera.shift[k]));
    this.touch();
  }

  pan(dx, dy) {
    const { camera } = this.paper;
    camera.shift = [camera.shift[0] + dx, camera.shift[1] + dy];
    this.touch();
  }

  orbit(dx, dy) {
    const { azimuth, elevation } = this.paper.camera;
    this.paper.turnTo(azimuth - 0.4 * dx, elevation + 0.4 * dy);
    this.touch();
  }

  /** Leave the sheet as a reader has moved it. */
  touch() {
    this.touched = true;
    this.draw();
  }

  /** Take the scales and the room that the motion needs now. */
  renew() {
    this.measure();
    this.ends = arrowEnds(this.shows, this.scale);
    if (this.touched) this.askFor();
    else this.place();
    this.draw();
  }

  /** Choose what is shown: something or not, or a section force by its name, or all in another size. */
  choose(what, value) {
    if (what === "ribbon" && value !== "" && !ribbonForces.some((force) => force.name === value)) return;
    this.shows[what] = value;
    this.controls[what]?.(value);
  }

  show(what, value) {
    this.choose(what, value);
    this.measure();
    this.askFor();
    this.trace();
    this.draw();
  }

  draw(instant = this.instant) {
    this.instant = instant;
    const { paper } = this;
    paper.begin();
    drawFloor(paper);
    const known = designState() !== "none";
    const gaps = known ? [] : live.engine.stand(instant);
    if (gaps) this.drawMechanism(instant, known);
    for (const gap of gaps ?? []) if (gap.ends) drawGap(paper, gap);
    paper.end();
    if (known) drawScales(this);
  }

  /** Draw the mechanism at an instant, and the forces where they are `known`. */
  drawMechanism(instant, known) {
    const { paper, shows } = this;
    drawTraces(paper, this.traces);
    const { ribbon } = this.scale;
    if (known && shows.ribbon && ribbon) for (const section of sections) drawRibbon(paper, section, section.forces.get(shows.ribbon), instant, ribbon);
    for (const body of bodies.values()) drawBody(paper, body, instant);
    for (const load of springs) between(paper, load, ...load.spots.map((spot) => spotOf(spot, instant)));
    drawCarried(paper, instant);
    for (const joint of contents.joints) drawJoint(paper, joint, instant);
    for (const path of contents.paths) stamp(paper, "point", paper.on(spotOf(path, instant)), ORDER.joints, Infinity);
    drawActions(paper, instant, shows, this.scale, shows.values);
    if (shows.names) drawNames(paper, instant);
    live.drag?.draw(paper);
    for (const place of [this.pinned, this.pointed]) if (place) drawSection(paper, place, instant, place === this.pinned);
  }
}

/** A faint net of round distances: on the level under a mechanism in space, behind one in the plane. */
function drawFloor(paper) {
  const { context } = paper;
  paper.put(ORDER.floor, 0, () => {
    context.beginPath();
    if (contents.space) floorOfSpace(paper, context);
    else netOfPlane(paper, context);
    strokeWith(context, paper.inks.faint, 1);
  });
}

function netOfPlane(paper, context) {
  const step = roundStep(70 / paper.camera.scale, ROUND);
  const [zeroX, zeroY] = paper.on([0, 0, 0]);
  const gap = step * paper.camera.scale;
  const places = (zero, side) => multiplesBetween(-zero, side - zero, gap).map((place) => Math.round(place + zero) + 0.5);
  for (const x of places(zeroX, paper.width)) addLine(context, [x, 0], [x, paper.height]);
  for (const y of places(zeroY, paper.height)) addLine(context, [0, y], [paper.width, y]);
}

function floorOfSpace(paper, context) {
  const [right, away, up] = contents.upright;
  const low = extent.floor - 0.06 * extent.size;
  const step = roundStep(extent.size / 8, ROUND);
  const [a, b] = [right, away].map((axis) => Math.round(dot(extent.middle, axis) / step));
  const at = (i, j) => paper.on(plus(plus(times(right, (a + i) * step), away, (b + j) * step), up, low));
  const reach = 6;
  for (let k = -reach; k <= reach; k += 1) {
    addLine(context, at(k, -reach), at(k, reach));
    addLine(context, at(-reach, k), at(reach, k));
  }
}

/** The ways of declared points, and of joints, as far as they are shown and they move. */
function tracesNow(shows) {
  const step = Math.max(1, Math.ceil(instants.count / (live.moving ? 80 : 240)));
  const numbers = Array.from({ length: Math.ceil(instants.count / step) }, (_, k) => k * step);
  if (numbers.at(-1) !== instants.count - 1) numbers.push(instants.count - 1);
  const of = (spot) => numbers.map((i) => spotOf(spot, i));
  const moved = (points) => points.some((point) => sizeOf(less(point, points[0])) > 1e-6 * extent.size);
  const joints = shows.ways ? contents.joints.map((joint) => ({ own: false, points: of(joint.child) })) : [];
  const paths = shows.traces ? contents.paths.map((path) => ({ own: true, points: of(path) })) : [];
  return [...joints, ...paths].filter((trace) => moved(trace.points));
}

function drawTraces(paper, traces) {
  for (const { own, points } of traces) {
    const line = points.map((point) => paper.on(point));
    paper.put(ORDER.traces, Number(own), (context) => {
      lineThrough(context, line);
      strokeWith(context, own ? paper.inks.path : sheer(paper.inks.soft, 0.45), own ? 1.8 : 1);
    });
  }
}

/** The gap of a loop that does not close, between its ends, with how wide it is. */
function drawGap(paper, { ends, size }) {
  const line = ends.map((end) => paper.on(end));
  const [x, y] = [0, 1].map((k) => (line[0][k] + line[1][k]) / 2);
  paper.put(ORDER.names, 1, (context) => {
    context.setLineDash([5, 4]);
    lineThrough(context, line);
    strokeWith(context, paper.inks.bad, 2.4);
    context.font = "bold 12px system-ui, sans-serif";
    context.setLineDash([]);
    writeOn(context, size, x + 8, y - 8, paper.inks.bad, sheer(paper.inks.sheet, 0.85), 3.5);
  });
}

/** A section that is pointed at, or pinned: a cut across its link. */
function drawSection(paper, { link, ratio }, instant, pinned) {
  const { xi, length } = sectionByLink.get(link);
  const at = placeOf(link, [xi[ratio] * length, 0, 0], instant);
  const [x, y] = paper.on(at);
  const [, dx, dy] = wayTo([0, 0], paper.along(directionOf(link, [1, 0, 0], instant)));
  const half = 2.2 * pinSize(paper);
  paper.put(ORDER.names, -1, (context) => {
    if (!pinned) context.setLineDash([4, 3]);
    lineThrough(context, [[x - half * dy, y + half * dx], [x + half * dy, y - half * dx]]);
    strokeWith(context, paper.inks.accent, pinned ? 3 : 2);
  });
}

/** Where a name may stand beside its point, from it: near ones first, then farther ones all around. */
function placesOfName(r, wide) {
  const near = [[r, -r], [-r - wide, -r], [r, r], [-r - wide, r], [r, 0], [-r - wide, 0], [-wide / 2, -2 * r], [-wide / 2, 2 * r]];
  const around = [28, 44, 64, 90].flatMap((reach) =>
    Array.from({ length: 12 }, (_, k) => [Math.cos((k * Math.PI) / 6), Math.sin((k * Math.PI) / 6)]).map(([c, s]) => [reach * c + ((c - 1) * wide) / 2, reach * s]),
  );
  return [...near.map((place) => [...place, 0]), ...around.map((place) => [...place, 1 + Math.hypot(place[0] + wide / 2, place[1]) / 60])];
}

/** The names of joints and declared points, those at one place together, beside them where there is room: farther off with a line to their point. */
function drawNames(paper, instant) {
  const spots = [];
  const joints = contents.joints.filter((joint) => contents.named.includes(joint.name)).map((joint) => [joint.name, joint.child]);
  for (const [name, spot] of [...joints, ...contents.paths.map((path) => [path.name, path])]) {
    const [x, y] = paper.on(spotOf(spot, instant));
    const near = spots.find((other) => Math.hypot(other.x - x, other.y - y) < 6);
    if (near) near.words += `, ${name}`;
    else spots.push({ x, y, words: name });
  }
  const pins = contents.joints.map((joint) => paper.on(spotOf(joint.child, instant)));
  const taken = [];
  const r = pinSize(paper) + 7;
  paper.put(ORDER.names, 0, (context) => {
    context.font = "12px system-ui, sans-serif";
    context.textBaseline = "middle";
    for (const spot of spots) {
      const wide = context.measureText(spot.words).width + 4;
      const cost = ({ x, y, far }) =>
        far +
        taken.filter((other) => Math.abs(other.y - y) < 14 && x < other.x + other.wide && other.x < x + wide).length * 40 +
        pins.filter(([px, py]) => px > x - 4 && px < x + wide + 4 && Math.abs(py - y) < r - 2).length * (far ? 0.5 : 1) +
        (x < 2 || x + wide > paper.width - 2 || y < 8 || y > paper.height - 8 ? 30 : 0);
      const boxes = placesOfName(r, wide).map(([x, y, far]) => ({ x: spot.x + x, y: spot.y + y, far, wide }));
      const best = boxes.reduce((least, box) => (cost(box) < cost(least) ? box : least));
      taken.push(best);
      if (best.far) {
        lineThrough(context, [[spot.x, spot.y], [Math.max(best.x, Math.min(best.x + wide, spot.x)), best.y]]);
        strokeWith(context, sheer(paper.inks.soft, 0.6), 1);
      }
      writeOn(context, spot.words, best.x, best.y, paper.inks.ink, sheer(paper.inks.sheet, 0.85), 3.5);
    }
  });
}

/** The scales to which lengths, forces and ordinates are drawn, each as a bar with a round value; and in space the axes. */
function drawScales(stage) {
  const { paper, scale, shows } = stage;
  const { context, camera } = paper;
  const bars = [["m", camera.scale, paper.inks.ink, ""]];
  if (scale.force) bars.push(["N", scale.force * camera.scale, paper.inks.reaction, "forces"]);
  if (scale.moment && contents.space) bars.push(["N m", scale.moment * camera.scale, paper.inks.effort, "moments"]);
  const ribbon = ribbonForces.find((force) => force.name === shows.ribbon);
  if (ribbon && scale.ribbon) bars.push([ribbon.unit, scale.ribbon * camera.scale, paper.inks.positive, ribbon.what]);
  context.save();
  context.font = "11px system-ui, sans-serif";
  context.textBaseline = "middle";
  context.lineCap = "butt";
  bars.forEach(([unit, points, ink, words], k) => {
    const value = roundStep(55 / points, ROUND);
    const y = paper.height - 14 - 17 * (bars.length - 1 - k);
    lineThrough(context, [[14, y - 4], [14, y], [14 + value * points, y], [14 + value * points, y - 4]]);
    strokeWith(context, ink, 2);
    const text = `${shown(value, unit)}${words ? ` · ${words}` : ""}`;
    writeOn(context, text, 22 + value * points, y - 2, paper.inks.soft, sheer(paper.inks.sheet, 0.8), 3);
  });
  if (contents.space) drawTriad(paper, context);
  context.restore();
}

function drawTriad(paper, context) {
  const [x, y] = [paper.width - 44, paper.height - 44];
  context.font = "12px system-ui, sans-serif";
  context.textAlign = "center";
  GROUND.slice(1).forEach((axis, k) => {
    const [dx, dy] = paper.along(axis).map((part) => (part / paper.camera.scale) * 26);
    lineThrough(context, [[x, y], [x + dx, y + dy]]);
    strokeWith(context, paper.inks.soft, 1.5);
    context.fillStyle = paper.inks.ink;
    context.fillText("xyz"[k], x + 1.35 * dx, y + 1.35 * dy);
  });
}
