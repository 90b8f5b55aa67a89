// How bodies are drawn, from the numbers of a design: as the package finds it for the design of the file.

const FLAT = 1e-6; // Over a body's size: points that are no farther from a plane, or from a line, lie in it.

/**
 * Axis, arms, plates and disc of a body; `spots` are the places on it at which something holds or pulls it, or that are declared, those
 * of rollers with a radius; `outlines` are what it is drawn as, where that is declared.
 */
function shapeOf(kind, length, centre, spots, outlines) {
  const own = spots.map((spot) => spot.at);
  const rollers = spots.filter((spot) => spot.radius).map(({ at: [x, y], radius }) => circleOf([x, y, 0], [1, 0, 0], [0, 1, 0], radius));
  const places = own.filter((at, k) => own.findIndex((other) => other.every((value, i) => value === at[i])) === k);
  const shape = { length, axis: [], arms: [], plates: [], centre: null, disc: 0 };
  if (kind === "point") return { ...shape, length: null, centre: [0, 0, 0] };
  if (kind === "rigid") {
    const plates = outlines.length ? outlines : platesOf(places);
    const ends = places.length === 2 ? [places] : places.filter((at) => sizeOf(less(at, centre))).map((at) => [centre, at]);
    const arms = plates.length ? [] : ends;
    return { ...shape, arms, plates: [...plates, ...rollers], centre, disc: arms.length || plates.length ? 0 : Math.max(length, 0) };
  }
  if (outlines.length) return { ...shape, plates: [...outlines, ...rollers] };
  const axis = [[0, 0, 0], [length, 0, 0]];
  const beside = places.filter((at) => Math.hypot(at[1], at[2]) > FLAT * (Math.abs(length) || 1) || !(at[0] >= 0 && at[0] <= length));
  const plates = beside.length ? platesOf([...axis, ...beside]) : [];
  const arms = plates.length ? [] : beside.map((at) => [[Math.min(Math.max(at[0], 0), length), 0, 0], at]);
  return { ...shape, axis, arms, plates: [...plates, ...rollers] };
}

/** The convex polygon of three places or more that lie in one plane and not in a line; else nothing. */
function platesOf(places) {
  if (places.length < 3) return [];
  const middle = times(places.reduce((sum, at) => plus(sum, at)), 1 / places.length);
  const from = places.map((at) => less(at, middle));
  const size = Math.max(...from.flat().map(Math.abs)) || 1;
  const farthest = from.reduce((best, at) => (sizeOf(at) > sizeOf(best) ? at : best));
  const first = unit(farthest);
  const rests = from.map((at) => plus(at, first, -dot(at, first)));
  const widest = rests.reduce((best, at) => (sizeOf(at) > sizeOf(best) ? at : best));
  if (sizeOf(widest) < 1e3 * FLAT * size) return [];
  const second = unit(widest);
  const normal = cross(first, second);
  if (from.some((at) => Math.abs(dot(at, normal)) > 1e3 * FLAT * size)) return [];
  // A corner is farthest in some direction.
  const corners = circleOf([0, 0, 0], first, second, 1, 360).map((way) => closest(places.length, (k) => -dot(from[k], way)));
  return [[...new Set(corners)].map((k) => places[k])];
}
