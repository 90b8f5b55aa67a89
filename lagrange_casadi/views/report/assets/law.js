// The forces inside links: the law of each link summed up as the file's own grids are.

const sections = contents.sections.map((entry) => {
  const loads = entry.loads.map(({ name, ...members }) => Object.fromEntries(Object.entries(members).map(([member, number]) => [member, array(number)])));
  const forces = new Map(entry.forces.map((force) => [force.name, force]));
  const xi = array(entry.xi);
  // `own` is room for the parts of a size, one after another.
  return { link: entry.link, length: entry.length, slack: entry.slack, xi, loads, forces, own: new Float64Array(xi.length) };
});

const sectionByLink = new Map(sections.map((section) => [section.link, section]));

/** The ratio beyond which a section takes the load of a load point: see edge in engine/section_function.py. */
function edgeAt({ slack }, xi, side = "tip") {
  return side === "tip" ? Math.min(xi + slack, 1 - slack) : Math.max(xi - slack, slack);
}

/** A force at an instant, at the ratio with a number, on the tip's side of a station. */
function sectionForce(section, name, instant, ratio) {
  return forceAt(section, section.forces.get(name), instant, section.xi[ratio], (row) => row[ratio], "tip");
}

function forceAt(section, force, instant, xi, along, side) {
  if (force.parts.length) {
    return Math.hypot(...force.parts.map((part) => forceAt(section, section.forces.get(part), instant, xi, along, side)));
  }
  let sum = 0;
  for (const [coefficient, row, sign] of force.terms) sum += sign * array(coefficient)[instant] * along(array(row));
  const edge = edgeAt(section, xi, side);
  for (const load of section.loads) {
    const station = load.station[instant];
    if (edge < station) {
      sum += load[force.acting][instant];
      if (force.arm) sum += force.arm * section.length * load[force.across][instant] * (station - xi);
    }
  }
  return sum;
}

/** A force at an instant at every so manieth ratio of a link, on the tip's side of stations, into `found`; returns that. */
function sectionForces(section, name, instant, found, step = 1) {
  const force = section.forces.get(name);
  const { xi } = section;
  found.fill(0);
  if (force.parts.length) {
    const { own } = section;
    for (const part of force.parts) {
      sectionForces(section, part, instant, own, step);
      for (let k = 0; k < found.length; k += step) found[k] += own[k] * own[k];
    }
    for (let k = 0; k < found.length; k += step) found[k] = Math.sqrt(found[k]);
    return found;
  }
  for (const [coefficient, row, sign] of force.terms) {
    const [factor, along] = [sign * array(coefficient)[instant], array(row)];
    for (let k = 0; k < found.length; k += step) found[k] += factor * along[k];
  }
  for (const load of section.loads) {
    const [station, acts] = [load.station[instant], load[force.acting][instant]];
    const lever = force.arm ? force.arm * section.length * load[force.across][instant] : 0;
    for (let k = 0; k < found.length; k += step) if (edgeAt(section, xi[k]) < station) found[k] += acts + lever * (station - xi[k]);
  }
  return found;
}

/** A force at one ratio of a link at all instants, on the tip's side of stations, into `found`. */
function sectionOverInstants(section, name, ratio, found) {
  const force = section.forces.get(name);
  if (force.parts.length || section.loads.length) {
    for (let i = 0; i < found.length; i += 1) found[i] = sectionForce(section, name, i, ratio);
    return;
  }
  found.fill(0);
  for (const [coefficient, row, sign] of force.terms) {
    const [values, along] = [array(coefficient), array(row)[ratio]];
    for (let i = 0; i < found.length; i += 1) found[i] += sign * values[i] * along;
  }
}

/** A force along a link at an instant: ratios and values, twice at each station; by straight lines between the ratios of which the functions
 *  along the link are known. */
function forceAlong(section, name, instant, step = 2) {
  const [ratios, values] = [[], []];
  const stations = new Set(section.loads.map((load) => load.station[instant]).filter((u) => u > 0 && u < 1));
  const last = section.xi.length - 1;
  const places = new Set([...section.xi.filter((_, k) => k % step === 0), ...stations]);
  for (const xi of [...places].sort((a, b) => a - b)) {
    const left = Math.max(0, Math.min(last - 1, Math.floor(xi * last)));
    const part = xi * last - left;
    const between = (row) => (part ? row[left] + part * (row[left + 1] - row[left]) : row[left]);
    for (const side of stations.has(xi) ? ["base", "tip"] : ["tip"]) {
      ratios.push(xi);
      values.push(forceAt(section, section.forces.get(name), instant, xi, between, side));
    }
  }
  return { ratios, values };
}

/** The forces of a link that equilibrium determines. */
function knownForces(section) {
  return [...section.forces.values()].filter((force) => !force.open);
}

/** Whether a force has a sign: resultants have none. */
function signed(force) {
  return force.parts.length === 0;
}
