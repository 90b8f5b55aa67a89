// Where bodies are: places and directions in ground axes at an instant.

const bodies = new Map(
  contents.bodies.map((body, number) => [body.name, { ...body, number, pose: body.pose.map((column) => array(column)) }]),
);

const GROUND = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]];

/** Place and axes of a body at an instant: [origin, x, y, z]. */
function frameOf(name, instant) {
  const body = bodies.get(name);
  if (!body) return GROUND;
  const at = body.pose.map((column) => column[instant]);
  if (contents.space) return [at.slice(0, 3), at.slice(3, 6), at.slice(6, 9), at.slice(9, 12)];
  const [c, s] = [Math.cos(at[2]), Math.sin(at[2])];
  return [[at[0], at[1], 0], [c, s, 0], [-s, c, 0], [0, 0, 1]];
}

/** Every so manieth instant of all, so that they are about `most`. */
function someInstants(most) {
  const step = Math.max(1, Math.floor(instants.count / most));
  return Array.from({ length: Math.ceil(instants.count / step) }, (_, k) => k * step);
}

/** The springs among the loads, and the like. */
const springs = contents.loads.filter((load) => load.kind === "spring");

/** The places on bodies at which something holds or pulls them, or that are declared. */
const spotsNow = () => [...contents.joints.flatMap((joint) => [joint.parent, joint.child]), ...springs.flatMap((load) => load.spots), ...contents.paths];

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
  return placeIn([[0, 0, 0], ...frameOf(body, instant).slice(1)], local);
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
function circleOf(middle, x, y, radius, count = 48) {
  const angles = Array.from({ length: count }, (_, k) => (2 * Math.PI * k) / count);
  return angles.map((angle) => plus(plus(middle, x, radius * Math.cos(angle)), y, radius * Math.sin(angle)));
}

/** All places between which something is drawn, at some instants of the whole. */
function cloud() {
  const found = [];
  for (const i of someInstants(120)) {
    for (const body of bodies.values()) {
      const own = [...body.axis, ...body.arms.flat(), ...body.plates.flat()];
      if (!own.length) own.push(body.centre ?? [0, 0, 0]);
      if (body.around) for (const d of acrossOf(body.around)) own.push(plus(body.centre, d, body.disc), plus(body.centre, d, -body.disc));
      const frame = frameOf(body.name, i);
      for (const at of own) found.push(placeIn(frame, at));
    }
    for (const spot of spotsNow()) found.push(spotOf(spot, i));
    for (const line of contents.carried) {
      const frame = frameOf(line.body, i);
      for (let k = 0; k < line.points.length; k += 6) found.push(placeIn(frame, line.points[k]));
    }
  }
  return found.filter((place) => place.every(Number.isFinite));
}

let allPlaces = [];

/** The middle of the mechanism over all instants, its lowest level, and its largest extent [m]. */
let extent = null;

/** Find both for the motion that there is now. */
function measureAll() {
  allPlaces = cloud();
  const endsAlong = (axis) => endsOf(allPlaces.map((place) => dot(place, axis)));
  const ends = GROUND.slice(1).map(endsAlong);
  const [floor] = endsAlong(contents.upright[2]);
  extent = { middle: ends.map(([low, high]) => (low + high) / 2), floor, size: Math.max(...ends.map(([low, high]) => high - low)) || 1 };
}

measureAll();

/** Half the width of a link as it is drawn [m]: of the mechanism's size, and no more than a short link bears. */
const girth = 0.013 * extent.size;
