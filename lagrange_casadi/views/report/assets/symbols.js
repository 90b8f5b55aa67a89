// Joints by their symbols, and the marks of what stands still.

/** How large symbols are on the sheet: half the width of a pin [points]. */
function pinSize(paper) {
  return Math.max(4, Math.min(13, 1.25 * girth * paper.camera.scale));
}

/** A joint at an instant. */
function drawJoint(paper, joint, instant) {
  const place = spotOf(joint.child, instant);
  const parent = spotOf(joint.parent, instant);
  const axes = joint.axes.map((axis) => directionOf(joint.parent.body, axis, instant));
  const grounded = joint.kind !== "free" && (joint.parent.body === "ground" || joint.child.body === "ground");
  if (grounded && !slides(joint)) {
    const on = paper.on(joint.parent.body === "ground" ? parent : place);
    stamp(paper, "stand", on, contents.space ? ORDER.solids : ORDER.rails, on[2] - 0.01 * extent.size);
  }
  if (slides(joint)) rail(paper, joint, parent, axes[0]);
  if (contents.space) inSpace(paper, joint, place, axes, instant);
  else inPlane(paper, joint, place, axes[0]);
}

function slides(joint) {
  return ["prismatic", "slot", "cylindrical"].includes(joint.kind);
}

/** Half the width of a pin of the symbols [points]. */
const PIN = 4.8;

/** A symbol that all pictures of the package share, at a point of the sheet. */
function stamp(paper, kind, [x, y], order, depth, { turn = 0, ...own } = {}) {
  const inks = { ...paper.inks, body: paper.inks.metal, ...own };
  const size = pinSize(paper) / PIN;
  paper.put(order, depth, (context) => {
    context.translate(x, y);
    context.rotate(turn);
    context.scale(size, -size);
    for (const one of contents.symbols[kind]) {
      lineThrough(context, one.points, one.closed);
      if (one.fill) fillWith(context, inks[one.fill]);
      strokeWith(context, inks[one.ink], one.width);
    }
  });
}

function inPlane(paper, joint, place, axis) {
  const on = paper.on(place);
  const [dx, dy] = paper.along(axis);
  const turn = slides(joint) ? Math.atan2(dy, dx) : 0;
  // A block never hides the pin that goes through it.
  const depth = joint.kind === "prismatic" ? -1 : 0;
  stamp(paper, joint.kind, on, ORDER.joints, depth, joint.driven.length ? { turn, ink: paper.inks.effort } : { turn });
  if (joint.driven.length && joint.kind !== "prismatic") stamp(paper, "drive", on, ORDER.joints, depth, { ink: paper.inks.effort });
}

function inSpace(paper, joint, place, axes, instant) {
  const { metal, effort } = paper.inks;
  const colour = joint.driven.length ? effort : metal;
  const wide = pinSize(paper) / paper.camera.scale;
  const triad = (axis) => [axis, ...acrossOf(axis)];
  if (joint.kind === "revolute") cylinder(paper, place, axes[0], 1.6 * wide, 1.2 * wide, colour);
  else if (joint.kind === "prismatic") box(paper, place, triad(axes[0]), [2 * wide, 1.3 * wide, 1.3 * wide], colour);
  else if (joint.kind === "cylindrical") cylinder(paper, place, axes[0], 2.2 * wide, 1.2 * wide, colour);
  else if (joint.kind === "screw") screw(paper, place, axes[0], wide, colour);
  else if (joint.kind === "spherical") ball(paper, place, pinSize(paper) * 1.15, colour);
  else if (joint.kind === "universal") {
    const second = joint.second ? directionOf(joint.child.body, joint.second, instant) : axes[1];
    for (const axis of [axes[0], second]) if (axis) cylinder(paper, place, axis, 1.7 * wide, 0.5 * wide, colour);
    ball(paper, place, pinSize(paper) * 0.75, colour);
  } else if (joint.kind === "planar") {
    const normal = axes.length > 2 ? axes[2] : cross(axes[0], axes[1]);
    box(paper, place, triad(unit(normal)), [0.25 * wide, 2 * wide, 2 * wide], colour);
  } else if (joint.kind === "slot") {
    box(paper, place, triad(axes[0]), [1.8 * wide, 0.9 * wide, 0.9 * wide], colour);
    ball(paper, place, pinSize(paper) * 0.9, colour);
  } else if (joint.kind === "weld") box(paper, place, GROUND.slice(1), [0.6 * wide, 0.6 * wide, 0.6 * wide], colour);
}

function screw(paper, place, axis, wide, colour) {
  cylinder(paper, place, axis, 2.2 * wide, 1.1 * wide, colour);
  for (let k = -3; k <= 3; k += 1) {
    const [x, y, depth] = paper.on(plus(place, axis, 0.6 * k * wide));
    const [dx, dy] = paper.along(axis);
    const turn = Math.atan2(dy, dx) + 0.3;
    const r = pinSize(paper) * 1.05;
    paper.put(ORDER.solids, depth + 1.2 * wide, (context) => {
      lineThrough(context, [[x - r * Math.sin(turn), y + r * Math.cos(turn)], [x + r * Math.sin(turn), y - r * Math.cos(turn)]]);
      strokeWith(context, shade(colour, -0.5), 1);
    });
  }
}

/** Between which places a joint slides over all instants, along its parent's axis [m]. */
function reachOf(joint) {
  const wayAt = (i) => dot(less(spotOf(joint.child, i), spotOf(joint.parent, i)), directionOf(joint.parent.body, joint.axes[0], i));
  return (joint.reach ??= endsOf(someInstants(240).map(wayAt)));
}

/** The line on which something slides, as far as it ever does. */
function rail(paper, joint, parent, axis) {
  const [low, high] = reachOf(joint);
  const more = 3.5 * pinSize(paper) / paper.camera.scale;
  const [a, b] = [paper.on(plus(parent, axis, low - more)), paper.on(plus(parent, axis, high + more))];
  const [length] = wayTo(a, b);
  if (length < 1) return;
  paper.put(ORDER.rails, a[2], (context) => {
    context.setLineDash([7, 4]);
    lineThrough(context, [a, b]);
    strokeWith(context, paper.inks.soft, 1.2);
  });
}

/** Links that slide within others, as rods in cylinders: they are drawn thinner, and inside. */
const inner = new Set(
  contents.joints
    .filter((joint) => slides(joint) && [joint.parent, joint.child].every((spot) => bodies.get(spot.body)?.axis.length))
    .filter((joint) => Math.abs(dot(unit(directionOf(joint.parent.body, [1, 0, 0], 0)), unit(directionOf(joint.child.body, [1, 0, 0], 0)))) > 0.999)
    .map((joint) => joint.child.body),
);

/** A body at an instant. */
function drawBody(paper, body, instant) {
  const colour = paper.inks.bodies[body.number % BODY_COLOURS];
  const at = (place) => placeOf(body.name, place, instant);
  for (const corners of body.plates) plate(paper, corners.map(at), colour);
  const thin = inner.has(body.name) ? 0.55 : body.plates.length ? 0.7 : 1;
  if (body.axis.length && body.length) bar(paper, at(body.axis[0]), at(body.axis[1]), thin * girth, colour, inner.has(body.name));
  for (const [start, stop] of body.arms) bar(paper, at(start), at(stop), (body.kind === "rigid" ? 0.9 : 0.6) * girth, colour);
  if (body.around) disc(paper, body, instant, colour);
  if (body.kind === "point") block(paper, at([0, 0, 0]), colour);
  else if (body.centre && !body.around) {
    const on = paper.on(at(body.centre));
    stamp(paper, "centre", on, ORDER.joints, on[2]);
  }
}

/** A rotor: a wheel with a spoke by which one sees it turn. */
function disc(paper, body, instant, colour) {
  const [origin, x, y] = [placeOf(body.name, body.centre, instant), ...acrossOf(body.around).map((d) => directionOf(body.name, d, instant))];
  plate(paper, circleOf(origin, x, y, body.disc), colour);
  bar(paper, origin, plus(origin, x, 0.85 * body.disc), 0.5 * girth, colour);
}

/** A point mass: a block, behind the joint that carries it. */
function block(paper, place, body) {
  const half = (1.7 * pinSize(paper)) / paper.camera.scale;
  if (contents.space) box(paper, place, GROUND.slice(1), [half, half, half], body);
  else stamp(paper, "mass", paper.on(place), ORDER.solids, 0, { body });
}

/** The lines that move with bodies, where they are of the numbers that these have. */
function drawCarried(paper, instant) {
  if (live.engine && !live.engine.carries) return;
  for (const line of contents.carried) {
    const frame = frameOf(line.body, instant);
    const points = line.points.map((at) => paper.on(placeIn(frame, at)));
    const depth = points.reduce((sum, [, , near]) => sum + near, 0) / points.length;
    const ink = line.of ? paper.inks.bodies[bodies.get(line.of).number % BODY_COLOURS] : paper.inks.soft;
    paper.put(ORDER.solids, depth, (context) => {
      if (line.dashed) context.setLineDash([5, 5]);
      lineThrough(context, points, line.closed);
      if (line.filled) fillWith(context, sheer(ink, 0.3));
      strokeWith(context, ink, line.width);
    });
  }
}
