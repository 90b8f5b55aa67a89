// Solids as they are painted: round bars, plates, balls, cylinders, boxes, springs.

const PIECE = 14;

/** A round bar between two places, behind another where it is `within` that; in space in pieces, so that bars which cross hide each other where they do. */
function bar(paper, start, stop, half, colour, within = false) {
  const back = within ? 2.5 * half : 0;
  const [a, b] = [paper.on(start), paper.on(stop)];
  const width = Math.max(2.2, half * paper.camera.scale);
  const [length] = wayTo(a, b);
  const count = contents.space ? Math.max(1, Math.min(live.moving ? 4 : 16, Math.ceil(length / PIECE / 2))) : 1;
  const at = (part) => [0, 1, 2].map((k) => a[k] + part * (b[k] - a[k]));
  for (let k = 0; k < count; k += 1) {
    const ends = [at(k / count), at((k + 1) / count)];
    const cap = count === 1 ? "round" : "butt";
    paper.put(ORDER.solids, (ends[0][2] + ends[1][2]) / 2 - back, (context) => paintBar(context, ends, width, colour, cap));
  }
  if (count > 1) for (const end of [a, b]) paper.put(ORDER.solids, end[2] - back - 1e-9, (context) => paintBar(context, [end, end], width, colour, "round"));
}

function paintBar(context, [a, b], half, colour, cap) {
  // Of pieces, what is inside reaches beyond the dark edge under it, so that no seam is seen between them.
  const strokes = [
    [shade(colour, -0.35), 2 * half, 0, 0],
    [colour, 2 * half - 2, 0, 0.8],
    [shade(colour, 0.38), 0.5 * half, 0.38 * half, 0.8],
  ];
  const [length, x, y] = wayTo(a, b);
  let [nx, ny] = length > 1e-6 ? [y, -x] : [-0.6, -0.8];
  if (0.55 * nx + 0.83 * ny > 0) [nx, ny] = [-nx, -ny];
  context.lineCap = cap;
  for (const [ink, width, aside, beyond] of strokes) {
    if (width <= 0.4) continue;
    const more = cap === "butt" ? beyond : 0;
    lineThrough(context, [
      [a[0] + aside * nx - more * x, a[1] + aside * ny - more * y],
      [b[0] + aside * nx + more * x + 1e-3, b[1] + aside * ny + more * y],
    ]);
    strokeWith(context, ink, width);
  }
}

/** A plate between places. */
function plate(paper, places, colour) {
  const corners = places.map((place) => paper.on(place));
  const depth = corners.reduce((sum, corner) => sum + corner[2], 0) / corners.length;
  const [first, second] = [less(places[1], places[0]), less(places[2], places[0])];
  const lit = Math.abs(dot(unit(cross(first, second)), unit(plus(paper.camera.toward, paper.camera.up, 0.5))));
  paper.put(ORDER.solids, depth - 0.02 * extent.size, (context) => {
    lineThrough(context, corners, true);
    fillWith(context, sheer(colour, contents.space ? 0.72 : 0.3));
    if (contents.space) fillWith(context, `rgb(255 255 255 / ${0.22 * lit})`);
    strokeWith(context, shade(colour, -0.2), 1.6);
  });
}

/** A ball [half its width in points of the sheet]. */
function ball(paper, place, half, colour) {
  const [x, y, depth] = paper.on(place);
  paper.put(ORDER.solids, depth, (context) => {
    const light = context.createRadialGradient(x - 0.35 * half, y - 0.4 * half, 0.1 * half, x, y, half);
    light.addColorStop(0, shade(colour, 0.6));
    light.addColorStop(0.5, colour);
    light.addColorStop(1, shade(colour, -0.35));
    circleAround(context, x, y, half);
    fillWith(context, light);
    strokeWith(context, shade(colour, -0.5), 0.9);
  });
}

/** A cylinder about an axis: its middle, half its length and its radius [m]. */
function cylinder(paper, middle, axis, half, radius, colour) {
  const facing = dot(axis, paper.camera.toward);
  const near = facing >= 0 ? 1 : -1;
  const ends = [-near, near].map((side) => paper.on(plus(middle, axis, side * half)));
  const r = Math.max(2.5, radius * paper.camera.scale);
  const [dx, dy] = paper.along(axis);
  const turn = Math.atan2(dy, dx);
  const flat = Math.max(Math.abs(facing), 1e-3);
  paper.put(ORDER.solids, paper.on(middle)[2], (context) => {
    const [n, m] = [-Math.sin(turn) * r, Math.cos(turn) * r];
    const side = context.createLinearGradient(ends[0][0] - n, ends[0][1] - m, ends[0][0] + n, ends[0][1] + m);
    const dark = shade(colour, -0.3);
    for (const [at, ink] of [[0, dark], [0.35, shade(colour, 0.35)], [0.6, colour], [1, dark]]) side.addColorStop(at, ink);
    context.beginPath();
    context.ellipse(ends[0][0], ends[0][1], flat * r, r, turn, 0, 2 * Math.PI);
    context.moveTo(ends[0][0] + n, ends[0][1] + m);
    context.lineTo(ends[1][0] + n, ends[1][1] + m);
    context.lineTo(ends[1][0] - n, ends[1][1] - m);
    context.lineTo(ends[0][0] - n, ends[0][1] - m);
    context.closePath();
    strokeWith(context, shade(colour, -0.6), 1.6);
    fillWith(context, side);
    context.beginPath();
    context.ellipse(ends[1][0], ends[1][1], flat * r, r, turn, 0, 2 * Math.PI);
    fillWith(context, shade(colour, 0.45));
    strokeWith(context, shade(colour, -0.6), 0.9);
  });
}

/** A box: its middle, three directions at right angles, and half its sides along them [m]. */
function box(paper, middle, directions, halves, colour) {
  paper.put(ORDER.solids, paper.on(middle)[2], (context) => {
    for (let k = 0; k < 3; k += 1) {
      const facing = dot(directions[k], paper.camera.toward);
      if (Math.abs(facing) < 1e-6) continue;
      const out = times(directions[k], Math.sign(facing) * halves[k]);
      const [i, j] = [0, 1, 2].filter((other) => other !== k);
      const corners = [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([p, q]) =>
        paper.on(plus(plus(plus(middle, out), directions[i], p * halves[i]), directions[j], q * halves[j])),
      );
      lineThrough(context, corners, true);
      const lit = Math.abs(dot(directions[k], unit(plus(paper.camera.toward, paper.camera.up, 0.8))));
      fillWith(context, shade(colour, 0.5 * lit - 0.12));
      strokeWith(context, shade(colour, -0.55), 1);
    }
  });
}

/** A spring, damper or gas spring between two places, by the polylines that all pictures of the package share. */
function between(paper, { lines, closed }, start, stop) {
  const [a, b] = [paper.on(start), paper.on(stop)];
  const [length, x, y] = wayTo(a, b);
  const wide = Math.max(4, 1.4 * girth * paper.camera.scale);
  const barrel = (closed * length) / (sizeOf(less(stop, start)) || 1);
  for (const line of lines) {
    const points = line.map(([share, side, , beyond]) => {
      const along = share * length + beyond * barrel;
      return [a[0] + along * x - side * wide * y, a[1] + along * y + side * wide * x];
    });
    paper.put(ORDER.solids, (a[2] + b[2]) / 2, (context) => {
      lineThrough(context, points);
      strokeWith(context, paper.inks.soft, 1.6);
    });
  }
}
