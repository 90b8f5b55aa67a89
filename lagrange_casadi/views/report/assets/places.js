// Where bodies are: places and directions in ground axes at an instant.

const bodies = new Map(
  contents.bodies.map((body, number) => [body.name, { ...body, number, pose: body.pose.map((column) => array(column)) }]),
);

const frames = new Map();
let framesOf = -1;

/** Place and axes of a body at an instant: [origin, x, y, z]. */
function frameOf(name, instant) {
  if (framesOf !== instant) {
    frames.clear();
    framesOf = instant;
  }
  if (!frames.has(name)) frames.set(name, worked(name, instant));
  return frames.get(name);
}

const GROUND = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]];

function worked(name, instant) {
  const body = bodies.get(name);
  if (!body) return GROUND;
  return frameFrom(body.pose.map((column) => column[instant]));
}

/** Place and axes of the numbers of a pose. */
function frameFrom(at) {
  if (at.length === 3) {
    const [x, y, angle] = at;
    const c = Math.cos(angle);
    const s = Math.sin(angle);
    return [[x, y, 0], [c, s, 0], [-s, c, 0], [0, 0, 1]];
  }
  return [at.slice(0, 3), at.slice(3, 6), at.slice(6, 9), at.slice(9, 12)];
}

/** A place of a body in ground axes. */
function placeOf(body, at, instant) {
  return placeIn(frameOf(body, instant), at);
}

function placeIn([origin, x, y, z], at) {
  return [0, 1, 2].map((k) => origin[k] + at[0] * x[k] + at[1] * y[k] + at[2] * z[k]);
}

function spotOf(spot, instant) {
  return placeOf(spot.body, spot.at, instant);
}

/** A direction that a body carries, in ground axes. */
function directionOf(body, local, instant) {
  const [, x, y, z] = frameOf(body, instant);
  return [0, 1, 2].map((k) => local[0] * x[k] + local[1] * y[k] + local[2] * z[k]);
}

const plus = (a, b, factor = 1) => [a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]];
const less = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const times = (a, factor) => [a[0] * factor, a[1] * factor, a[2] * factor];
const sizeOf = (a) => Math.hypot(...a);

/** The same direction, of length 1. */
function unit(a) {
  const size = sizeOf(a);
  return size ? times(a, 1 / size) : [1, 0, 0];
}

/** Two directions at right angles to one, and to each other. */
function acrossOf(axis) {
  const least = [0, 1, 2].reduce((best, k) => (Math.abs(axis[k]) < Math.abs(axis[best]) ? k : best), 0);
  const first = unit(cross(axis, [0, 1, 2].map((k) => Number(k === least))));
  return [first, cross(axis, first)];
}

/** The corners by which a circle about a middle is drawn; `x` and `y` are two directions at right angles. */
function circleOf(middle, x, y, radius) {
  const angles = Array.from({ length: 48 }, (_, k) => (2 * Math.PI * k) / 48);
  return angles.map((angle) => plus(plus(middle, x, radius * Math.cos(angle)), y, radius * Math.sin(angle)));
}

/** All places between which something is drawn, at some instants of the whole. */
function cloud() {
  const found = [];
  const step = Math.max(1, Math.floor(instants.count / 120));
  for (let i = 0; i < instants.count; i += step) {
    for (const body of bodies.values()) {
      const own = [...body.axis, ...body.arms.flat(), ...body.plates.flat()];
      if (!own.length) own.push(body.centre ?? [0, 0, 0]);
      if (body.around) for (const d of acrossOf(body.around)) own.push(plus(body.centre, d, body.disc), plus(body.centre, d, -body.disc));
      for (const at of own) found.push(placeOf(body.name, at, i));
    }
    for (const joint of contents.joints) found.push(spotOf(joint.parent, i), spotOf(joint.child, i));
    for (const load of contents.loads) if (load.kind === "spring") found.push(...load.spots.map((spot) => spotOf(spot, i)));
    for (const path of contents.paths) found.push(spotOf(path, i));
    for (const line of contents.carried) for (let k = 0; k < line.points.length; k += 6) found.push(placeOf(line.body, line.points[k], i));
  }
  return found.filter((place) => place.every(Number.isFinite));
}

let allPlaces = cloud();

/** The middle of the mechanism over all instants, and its largest extent [m]. */
let extent = extentNow();

function extentNow() {
  const endsAlong = (axis) => endsOf([allPlaces.map((place) => dot(place, axis))], false);
  const ends = GROUND.slice(1).map(endsAlong);
  const [floor] = endsAlong(contents.upright[2]);
  return { middle: ends.map(([low, high]) => (low + high) / 2), floor, size: Math.max(...ends.map(([low, high]) => high - low)) || 1 };
}

/** Find both anew. */
function measureAll() {
  allPlaces = cloud();
  extent = extentNow();
}

/** Half the width of a link as it is drawn [m]: of the mechanism's size, and no more than a short link bears. */
const girth = 0.013 * extent.size;
