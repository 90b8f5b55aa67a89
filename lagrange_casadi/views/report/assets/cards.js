// The cards beside the picture: each shows what its reader chooses.

const deck = { cards: [], list: null, stage: null };

/** A card whose plot goes with the motion, and with the sliders. */
class MovingCard extends Card {
  constructor(title, state, make) {
    super(title, state, make);
    this.legend = element("ul", { class: "legend" });
    this.field.before(this.legend);
    this.head.append(saveList(this), signButton("✕", "Remove this plot", () => this.remove(), { class: "sign small" }));
    this.seen = true;
    // What is out of sight need not go with the motion.
    this.watcher = new IntersectionObserver(([entry]) => {
      this.seen = entry.isIntersecting;
      this.mark(player.instant);
    });
    this.watcher.observe(this.body);
  }

  remove() {
    deck.cards.splice(deck.cards.indexOf(this), 1);
    this.watcher.disconnect();
    this.body.remove();
  }

  renew() {
    this.stale = false;
    if (live.moving && this.plot && !this.plot.field?.ofFile && this.width && designState() !== "none") {
      this.plot.follow(this.width);
      this.drawLegend();
      this.mark(player.instant);
      return;
    }
    showTip(null);
    const without = designState() === "none";
    this.plot = without ? null : this.make();
    const words = without ? "There is no such design." : (this.lacking ?? "Nothing is chosen.");
    this.field.replaceChildren(this.plot ? this.plot.sheet.body : element("p", { class: "none" }, words));
    this.drawLegend();
    this.draw();
  }

  /** Take what the arrays hold now: at once, or while a slider moves in its turn. */
  follow() {
    this.stale = live.moving;
    if (!this.stale) this.renew();
  }

  draw() {
    // A width that is asked for while much is new costs a whole layout.
    this.width = live.moving && this.width ? this.width : this.field.clientWidth;
    if (this.plot && this.width) this.plot.draw(this.width);
    this.mark(player.instant);
  }

  mark(instant) {
    if (!this.plot || !this.seen) return;
    if (this.plot.across || this.plot.middle) this.plot.mark(instant);
    this.values?.forEach(([curve, place]) => {
      say(place, shownOf(curve.values[instant], curve.unit, largestOf(curve.values)));
    });
  }

  drawLegend() {
    const curves = this.plot?.curves ?? [];
    if (live.moving && curves.length && curves.length === this.values?.length) return;
    this.values = [];
    this.legend.replaceChildren(
      ...curves.map((curve, k) => {
        const value = element("b", {});
        this.values.push([curve, value]);
        const drop = this.drop && signButton("✕", `Leave ${curve.title} out`, () => this.drop(k), { class: "sign tiny" });
        return element("li", {}, swatch(k), element("span", {}, curve.title), value, drop);
      }),
      ...(this.plot?.described?.() ?? []),
    );
  }
}

function addCard(kind, card, focus) {
  card.kind = kind;
  deck.cards.push(card);
  deck.list.append(card.body);
  card.renew();
  if (focus) card.body.scrollIntoView({ block: "nearest", behavior: "smooth" });
  return card;
}

/** Quantities over the instants, or over another one. */
function chartCard(names, along = alongInstants, focus = false) {
  const axes = [["Instants", [["t", "time"], ...(over ? [["over", over.joint]] : [])]], ...seriesEntries()];
  const state = { x: along, names: [...names] };
  const card = new MovingCard("", state, () => {
    const groups = [...new Set(state.names.map((name) => contents.groups[seriesByName.get(name).group]))];
    card.title.textContent = groups.length === 1 ? groups[0] : "Chart";
    return state.names.length ? new Chart(curveOf(state.x), state.names.map(curveOf)) : null;
  });
  const add = chooser("Add a curve", [["", "+ curve"], ...seriesEntries()], "", (name) => {
    if (name && !state.names.includes(name)) state.names.push(name);
    add.value = "";
    card.renew();
  });
  add.classList.add("curves");
  card.choices.append(add, element("label", {}, "over ", card.choose("x", "Over", axes)));
  card.drop = (k) => {
    state.names.splice(k, 1);
    card.renew();
  };
  return addCard("chart", card, focus);
}

const linkEntries = (links) => links.map(({ link }) => [link, link]);

/** All forces of one section over the instants. */
function sectionCard(section, ratio, focus = false) {
  const state = { section, ratio };
  const described = element("output", { class: "ratio" });
  const card = new MovingCard("A section", state, () => {
    const xi = state.section.xi[state.ratio];
    described.textContent = `ξ/l = ${format(xi, 3)}, ${shown(xi * state.section.length, "m", 4, state.section.length)} from the base`;
    const forces = knownForces(state.section).filter((force) => !contents.space || ["axial", "shear", "torsion", "bending"].includes(force.name));
    return forces.length ? new Chart(curveOf(alongInstants), forces.map((force) => curveOfSection(state.section, force, state.ratio))) : null;
  });
  const slider = element("input", {
    type: "range", min: 0, max: section.xi.length - 1, value: ratio, "aria-label": "Place along the link, ξ/l",
    input: () => card.pin({ section: state.section, ratio: Number(slider.value) }),
  });
  const link = chooser("Link", linkEntries(sections), section.link, (name) => card.pin({ section: sectionByLink.get(name), ratio: state.ratio }));
  card.pin = (pinned) => {
    Object.assign(state, pinned);
    link.value = state.section.link;
    slider.value = state.ratio;
    card.renew();
    deck.stage.pinned = { ...state };
    deck.stage.draw();
  };
  card.choices.append(link, slider, described);
  return addCard("section", card, focus);
}

/** Show the section of a link at a ratio. */
function showSection(link, xi) {
  const section = sectionByLink.get(link);
  pinSection({ section, ratio: Math.round(xi * (section.xi.length - 1)) }, false);
}

/** Pin a section: the card of sections shows it, and the picture marks it. */
function pinSection(pinned, focus = true) {
  const card = deck.cards.find((one) => one.pin) ?? sectionCard(pinned.section, pinned.ratio, focus);
  card.pin(pinned);
  const xi = format(pinned.section.xi[pinned.ratio], 3);
  announce(`${pinned.section.link} at xi/l = ${xi}: ${sectionLines(pinned.section, pinned.ratio, player.instant).map((line) => line.join(" ")).join(", ")}`);
}

/** What can be mapped of a link: its section forces, and what the page holds of it; each with a name, words and a field. */
function mappedOf(link) {
  const section = sectionByLink.get(link);
  const forces = knownForces(section).map((force) => ({ name: force.name, what: force.what, field: () => fieldOfForce(section, force) }));
  const held = contents.maps.filter((map) => map.link === link).map((map) => ({ name: map.name.split(":")[0], what: map.what, field: () => fieldOfMap(map), ofFile: true }));
  return [...forces, ...held];
}

/** A map along a link: of a section force by its name, or of "stress" or "deflection". */
function mapCard(link, name, focus = false) {
  const state = { link, name };
  const chosen = () => mappedOf(state.link).find((one) => one.name === state.name);
  const card = new MovingCard("Section map", state, () => {
    const one = chosen();
    return one.ofFile && designState() !== "file" ? null : new Heat(one.field());
  });
  card.lacking = "This map shows the file's design only; charts and peaks of stresses follow the sliders.";
  const offered = () => mappedOf(state.link).map((one) => [one.name, one.what]);
  const what = card.choose("name", "What is mapped", offered());
  const links = card.choose("link", "Link", linkEntries(sections.filter((one) => knownForces(one).length)), () => {
    if (!chosen()) state.name = offered()[0][0];
    offer(what, offered(), state.name);
  });
  card.choices.append(links, what);
  return addCard("map", card, focus);
}

/** N, V and M along a link, at the instant that governs it or at that which is shown. */
function diagramCard(link, focus = false, when = "governs") {
  const state = { link, when };
  const card = new MovingCard("Diagrams", state, () => new Diagram(sectionByLink.get(state.link), state.when));
  card.choices.append(
    card.choose("link", "Link", linkEntries(diagramLinks())),
    card.choose("when", "Instant", [["governs", "at the instant that governs"], ["shown", "at the instant shown"]]),
  );
  return addCard("diagram", card, focus);
}

function polarCard(joint, focus = false, way = "0") {
  const state = { joint: joint.name, way };
  const joints = polarJoints();
  const chosen = () => joints.find((one) => one.name === state.joint);
  const card = new MovingCard("Bearing load", state, () => new Polar(chosen(), polarWays(chosen())[state.way]));
  const offered = () => polarWays(chosen()).map((way, k) => [String(k), way.words]);
  const ways = card.choose("way", "Axes", offered());
  const list = card.choose("joint", "Joint", joints.map(({ name }) => [name, name]), () => {
    state.way = "0";
    offer(ways, offered(), "0");
  });
  card.choices.append(list, ways);
  return addCard("polar", card, focus);
}

/** The first cards: efforts, what the joints bear, the section that bends most, and the bearing that bears most. */
function firstCards() {
  const peakOf = (name) => Math.abs(rowByName.get(name)?.peak?.value ?? 0);
  const named = (group, filter = () => true) => contents.series.filter((one) => one.group === group && filter(one)).map((one) => one.name);
  const largest = (names, count) => [...names].sort((a, b) => peakOf(b) - peakOf(a)).slice(0, count);
  const efforts = named("effort");
  const resultants = named("reaction", (one) => one.name.endsWith(":resultant"));
  if (efforts.length) chartCard(largest(efforts, 6).sort((a, b) => efforts.indexOf(a) - efforts.indexOf(b)));
  const forces = ["bending", "axial", "shear"].flatMap((name) => sections.map((section) => [section, section.forces.get(name)]));
  const bent = forces.filter(([, force]) => force && !force.open).map(([section, force]) => [section, force, peakOf(`section:${section.link}:${force.name}`)]);
  const worst = bent.filter(([, force]) => force.name === bent[0][1].name).sort((a, b) => b[2] - a[2])[0];
  if (worst) {
    diagramCard(worst[0].link);
    mapCard(worst[0].link, worst[1].name);
    const peak = rowByName.get(`section:${worst[0].link}:${worst[1].name}`)?.peak;
    sectionCard(worst[0], Math.round((peak?.xi ?? 0.5) * (worst[0].xi.length - 1)));
  }
  const stressed = contents.maps.filter((map) => map.name.startsWith("stress:")).sort((a, b) => b.peak.value - a.peak.value)[0];
  if (stressed) mapCard(stressed.link, "stress");
  if (resultants.length) chartCard(largest(resultants, 5));
  const joints = polarJoints();
  const turning = joints.filter((joint) => joint.kind === "revolute");
  const most = [...(turning.length ? turning : joints)].sort((a, b) => peakOf(`reaction:${b.name}:resultant`) - peakOf(`reaction:${a.name}:resultant`))[0];
  if (most) polarCard(most);
  const own = named("output");
  if (own.length) chartCard(own.slice(0, 6));
  if (!deck.cards.length) chartCard(named("motion").slice(0, 1));
}

/** The buttons that add cards. */
function addingBar() {
  const driven = contents.series.find((one) => one.group === "motion" && one.what === "coordinate");
  const effort = contents.series.find((one) => one.group === "effort") ?? contents.series[0];
  const section = sections.find((one) => knownForces(one).length);
  const joint = polarJoints()[0];
  const button = (words, add) => element("button", { type: "button", class: "add", click: add }, `+ ${words}`);
  return element(
    "div", { class: "adding", role: "group", "aria-label": "Add a plot" },
    effort && button("chart", () => chartCard([effort.name], alongInstants, true)),
    effort && driven && button("cross-plot", () => chartCard([effort.name], driven.name, true)),
    section && button("section", () => pinSection({ section, ratio: 50 })),
    section && diagramLinks().length > 0 && button("diagrams", () => diagramCard(diagramLinks()[0].link, true)),
    section && button("section map", () => mapCard(section.link, knownForces(section)[0].name, true)),
    joint && button("polar plot", () => polarCard(joint, true)),
  );
}
