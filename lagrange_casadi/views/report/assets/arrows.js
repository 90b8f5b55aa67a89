// Forces and moments as arrows, all forces to one scale and all moments to another, both written beside the picture.

const KINDS = { reaction: "reactions", effort: "efforts", load: "loads" };

/** Every force and moment that can be shown: where it acts, its columns, and of an effort the axis along which it works. */
const actions = (() => {
  const column = (name) => (seriesByName.has(name) ? array(seriesByName.get(name).values) : null);
  const found = [];
  const vectors = (kind, name, spot) => {
    const [force, moment] = ["f", "m"].map((letter) => ["x", "y", "z"].map((axis) => column(`${kind}:${name}:${letter}${axis}`)));
    if (force.some(Boolean)) found.push({ kind, name, spot, columns: force, moment: false });
    if (moment.some(Boolean)) found.push({ kind, name, spot, columns: moment, moment: true });
  };
  for (const joint of contents.joints) {
    vectors("reaction", joint.name, joint.child);
    joint.coordinates.forEach(([name, kind], k) => {
      const values = column(`effort:${name}`);
      if (values) found.push({ kind: "effort", name, spot: joint.child, columns: [values], moment: kind === "angle", joint, axis: k });
    });
  }
  for (const load of contents.loads) vectors("load", load.name, load.spots[0]);
  return found;
})();

/** An action at an instant, as three components [N or N m]. */
function vectorOf(action, instant) {
  if (action.joint) {
    const axis = action.joint.axes[Math.min(action.axis, action.joint.axes.length - 1)];
    return times(directionOf(action.joint.parent.body, axis, instant), action.columns[0][instant]);
  }
  return action.columns.map((values) => (values ? values[instant] : 0));
}

/** The largest force, or moment, of all that are shown, over all instants. */
function largestAction(kinds, moment) {
  let found = 0;
  for (const action of actions) {
    if (!kinds[action.kind] || action.moment !== moment) continue;
    if (action.joint) found = Math.max(found, largestOf(action.columns[0]));
    else for (let i = 0; i < instants.count; i += 1) found = Math.max(found, sizeOf(vectorOf(action, i)) || 0);
  }
  return found;
}

/** Draw what acts at an instant; `scale` has metres of the sheet for a newton, and for a newton metre. */
function drawActions(paper, instant, kinds, scale, values) {
  for (const action of actions) {
    if (!kinds[action.kind]) continue;
    const vector = vectorOf(action, instant);
    const size = sizeOf(vector);
    const ink = paper.inks[action.kind];
    const place = spotOf(action.spot, instant);
    if (!(size > 0)) continue;
    const caption = values ? `${shown(size, action.moment ? "N m" : "N", 3)}` : "";
    if (action.moment && !contents.space) {
      turnArrow(paper, place, vector[2] * scale.moment, ink, action.kind, caption);
      continue;
    }
    const way = times(vector, action.moment ? scale.moment : scale.force);
    // An applied load pushes at its place; what a joint or drive does begins at its own.
    const [from, to] = action.kind === "load" ? [less(place, way), place] : [place, plus(place, way)];
    arrow(paper, from, to, ink, action, caption);
  }
}

/** The ends of arrows at some instants, so that all have room. */
function arrowEnds(kinds, scale) {
  const found = [];
  for (const i of someInstants(40)) {
    for (const action of actions) {
      if (!kinds[action.kind] || (action.moment && !contents.space)) continue;
      const way = times(vectorOf(action, i), action.moment ? scale.moment : scale.force);
      found.push(plus(spotOf(action.spot, i), way, action.kind === "load" ? -1 : 1));
    }
  }
  return found.filter((place) => place.every(Number.isFinite));
}

/** A straight arrow; of a moment with two heads. Heads differ by kind, for those who see no colours. */
function arrow(paper, from, to, ink, action, caption) {
  const [a, b] = [paper.on(from), paper.on(to)];
  const [length, x, y] = wayTo(a, b);
  if (length < 2) return;
  const head = Math.min(11, 0.7 * length);
  const tip = (back) => [b[0] - back * x, b[1] - back * y];
  paper.put(ORDER.arrows, b[2], (context) => {
    context.lineCap = "butt";
    lineThrough(context, [a, tip(0.8 * head)]);
    shaft(context, action.kind, ink);
    for (const back of action.moment ? [0, 0.8 * head] : [0]) {
      const [px, py] = tip(back);
      const wing = (side) => [px - head * x - side * 0.42 * head * y, py - head * y + side * 0.42 * head * x];
      lineThrough(context, [[px, py], wing(1), wing(-1)], true);
      if (action.kind === "load") strokeWith(context, ink, 1.5);
      fillWith(context, action.kind === "load" ? paper.inks.sheet : ink);
    }
    if (caption) writeBeside(paper, context, caption, action.kind === "load" ? [a[0] - 8 * x, a[1] - 8 * y] : [b[0] + 8 * x, b[1] + 8 * y], x, ink);
  });
}

/** An arrow around a place, counter-clockwise where positive; a whole unit sweeps most of a turn. */
function turnArrow(paper, place, sweep, ink, kind, caption) {
  const [x, y, depth] = paper.on(place);
  const r = 2.6 * pinSize(paper) + (kind === "reaction" ? 5 : 0);
  const angle = Math.max(-5.2, Math.min(5.2, sweep * 5.2));
  if (Math.abs(angle) * r < 3) return;
  const [start, stop] = [Math.PI / 2, Math.PI / 2 + angle];
  paper.put(ORDER.arrows, depth, (context) => {
    context.beginPath();
    context.arc(x, y, r, -start, -stop, angle > 0);
    shaft(context, kind, ink);
    const [ex, ey] = [x + r * Math.cos(stop), y - r * Math.sin(stop)];
    const lead = stop + Math.sign(angle) * (Math.PI / 2 + 0.18);
    const [tx, ty] = [Math.cos(lead), -Math.sin(lead)];
    const tip = [ex + 7 * tx, ey + 7 * ty];
    lineThrough(context, [tip, [ex - 4 * tx - 5 * ty, ey - 4 * ty + 5 * tx], [ex - 4 * tx + 5 * ty, ey - 4 * ty - 5 * tx]], true);
    fillWith(context, ink);
    if (caption) writeBeside(paper, context, caption, [x + r + 6, y - r], 1, ink);
  });
}

/** The line of an arrow, by what acts. */
function shaft(context, kind, ink) {
  context.setLineDash(kind === "load" ? [6, 3] : []);
  strokeWith(context, ink, kind === "effort" ? 3 : 2);
  context.setLineDash([]);
}

function writeBeside(paper, context, words, [x, y], way, ink) {
  context.font = "600 11px system-ui, sans-serif";
  context.textAlign = way >= 0 ? "left" : "right";
  context.textBaseline = "middle";
  writeOn(context, words, x, y, ink, paper.inks.sheet, 3.5);
}
