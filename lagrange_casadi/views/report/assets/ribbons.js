// Section forces as ribbons along moving links: ordinates to one scale, positive ones plain, negative ones hatched.

/** The section forces that can be chosen, in the order of the table. */
const ribbonForces = (contents.sections[0]?.forces ?? []).flatMap(({ name }) => {
  const known = sections.map((section) => section.forces.get(name)).findLast((force) => force && !force.open);
  return known ?? [];
});

/** The ribbon of a force on a link; `scale` is in metres of the sheet for a unit. */
function drawRibbon(paper, section, force, instant, scale) {
  if (force.open) return;
  const { ratios, values } = forceAlong(section, force.name, instant);
  // Ordinates are drawn along the link's y, or in space along its z where the force lies in that plane.
  const side = directionOf(section.link, ["shear_z", "bending_y"].includes(force.name) ? [0, 0, 1] : [0, 1, 0], instant);
  const [base, tip] = [0, section.length].map((x) => placeOf(section.link, [x, 0, 0], instant));
  const onAxis = (u) => paper.on([0, 1, 2].map((k) => base[k] + u * (tip[k] - base[k])));
  const [dx, dy] = paper.along(side);
  const [, , depth] = onAxis(0.5);
  paper.put(ORDER.ribbons, depth, (context) => {
    for (const sign of [1, -1]) {
      const ink = sign > 0 ? paper.inks.positive : paper.inks.negative;
      for (const part of partsOf(ratios, values, sign)) {
        const axis = part.map(([u]) => onAxis(u));
        const edge = part.map(([, value], k) => [axis[k][0] + value * scale * dx, axis[k][1] + value * scale * dy]);
        lineThrough(context, [...axis, ...edge.reverse()], true);
        fillWith(context, sheer(ink, sign > 0 ? 0.34 : 0.16));
        if (sign < 0) fillWith(context, paper.hatched(ink));
        strokeWith(context, ink, 1.3);
      }
    }
  });
}

/** The parts along a link in which values have a sign, as ratios and values, cut where the values pass through zero. */
function partsOf(ratios, values, sign) {
  const parts = [];
  values.forEach((value, k) => {
    const [here, before] = [sign * value > 0, sign * values[k - 1] > 0];
    if (here && !before) parts.push([]);
    if (k && here !== before) {
      const share = values[k - 1] / (values[k - 1] - value);
      parts.at(-1).push([ratios[k - 1] + share * (ratios[k] - ratios[k - 1]), 0]);
    }
    if (here) parts.at(-1).push([ratios[k], value]);
  });
  return parts;
}

/** What the section nearest to a point of the sheet is, within 18 points of it: the link and the number of its ratio. */
function sectionUnder(paper, instant, x, y) {
  let [best, least] = [null, 18];
  for (const section of sections) {
    const [base, tip] = [0, section.length].map((at) => paper.on(placeOf(section.link, [at, 0, 0], instant)));
    const [dx, dy] = [tip[0] - base[0], tip[1] - base[1]];
    const along = Math.max(0, Math.min(1, ((x - base[0]) * dx + (y - base[1]) * dy) / (dx * dx + dy * dy || 1)));
    const away = Math.hypot(base[0] + along * dx - x, base[1] + along * dy - y);
    if (away < least) [best, least] = [{ link: section.link, ratio: Math.round(along * (section.xi.length - 1)) }, away];
  }
  return best;
}

/** A section by its link and the number of its ratio, in words. */
function placeWords({ link, ratio }) {
  return `${link} at ξ/l = ${format(sectionByLink.get(link).xi[ratio], 3)}`;
}

/** What a section bears at an instant, in words: lines of a name and a value. */
function sectionLines({ link, ratio }, instant) {
  const section = sectionByLink.get(link);
  return knownForces(section).map((force) => [force.what, shown(sectionForce(section, force.name, instant, ratio), force.unit)]);
}
