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
    if (this.plot.sheet.width) this.plot.mark(instant);
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

/** Add a card of a kind, with what is to be chosen on it at first: names and numbers, so that these can be kept. */
function addCard(kind, chosen, focus = false) {
  const card = CARDS[kind](structuredClone(chosen));
  card.kind = kind;
  deck.cards.push(card);
  deck.list.append(card.body);
  card.renew();
  if (focus) card.body.scrollIntoView({ block: "nearest", behavior: "smooth" });
  return card;
}

const CARDS = { chart: chartCard, section: sectionCard, map: mapCard, diagram: diagramCard, polar: polarCard };

/** Quantities over the instants, or over another one: their names, and that of the other. */
function chartCard(state) {
  const axes = [["Instants", [["t", "time"], ...(over ? [["over", over.joint]] : [])]], ...seriesEntries()];
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
  return card;
}

const linkEntries = (links) => links.map(({ link }) => [link, link]);

/** All forces of one section over the instants: its link, and the number of its ratio. */
function sectionCard(state) {
  const described = element("output", { class: "ratio" });
  const card = new MovingCard("A section", state, () => {
    const section = sectionByLink.get(state.link);
    const xi = section.xi[state.ratio];
    described.textContent = `ξ/l = ${format(xi, 3)}, ${shown(xi * section.length, "m", 4, section.length)} from the base`;
    const forces = knownForces(section).filter((force) => !contents.space || ["axial", "shear", "torsion", "bending"].includes(force.name));
    return forces.length ? new Chart(curveOf(alongInstants), forces.map((force) => curveOfSection(section, force, state.ratio))) : null;
  });
  const last = sectionByLink.get(state.link).xi.length - 1;
  const slider = element("input", {
    type: "range", min: 0, max: last, value: state.ratio, "aria-label": "Place along the link, ξ/l",
    input: () => card.pin({ ratio: Number(slider.value) }),
  });
  const list = chooser("Link", linkEntries(sections), state.link, (link) => card.pin({ link }));
  card.pin = (pinned) => {
    Object.assign(state, pinned);
    list.value = state.link;
    slider.value = state.ratio;
    card.renew();
    deck.stage.pinned = { ...state };
    deck.stage.draw();
  };
  card.choices.append(list, slider, described);
  return card;
}

/** Show the section of a link at a ratio. */
function showSection(link, xi) {
  pinSection({ link, ratio: Math.round(xi * (sectionByLink.get(link).xi.length - 1)) }, false);
}

/** Pin a section: the card of sections shows it, and the picture marks it. */
function pinSection(pinned, focus = true) {
  const { link, ratio } = pinned;
  const card = deck.cards.find((one) => one.pin) ?? addCard("section", { link, ratio }, focus);
  card.pin({ link, ratio });
  const xi = format(sectionByLink.get(link).xi[ratio], 3);
  announce(`${link} at xi/l = ${xi}: ${sectionLines(pinned, player.instant).map((line) => line.join(" ")).join(", ")}`);
}

/** What can be mapped of a link: its section forces, and what the page holds of it; each with a name, words and a field. */
function mappedOf(link) {
  const section = sectionByLink.get(link);
  const forces = knownForces(section).map((force) => ({ name: force.name, what: force.what, field: () => fieldOfForce(section, force) }));
  const held = contents.maps.filter((map) => map.link === link).map((map) => ({ name: map.name.split(":")[0], what: map.what, field: () => fieldOfMap(map), ofFile: true }));
  return [...forces, ...held];
}

/** A map along a link: of a section force by its name, or of "stress" or "deflection". */
function mapCard(state) {
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
  return card;
}

/** N, V and M along a link, at the instant that "governs" it or at that which is "shown". */
function diagramCard(state) {
  const card = new MovingCard("Diagrams", state, () => new Diagram(sectionByLink.get(state.link), state.when));
  card.choices.append(
    card.choose("link", "Link", linkEntries(diagramLinks())),
    card.choose("when", "Instant", [["governs", "at the instant that governs"], ["shown", "at the instant shown"]]),
  );
  return card;
}

/** What a joint bears, by its name and the number of a way to look at that. */
function polarCard(state) {
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
  return card;
}

/** The first cards: efforts, what the joints bear, the section that bends most, and the bearing that bears most. */
function firstCards() {
  const peakOf = (name) => Math.abs(rowByName.get(name)?.peak?.value ?? 0);
  const named = (group, filter = () => true) => contents.series.filter((one) => one.group === group && filter(one)).map((one) => one.name);
  const largest = (names, count) => [...names].sort((a, b) => peakOf(b) - peakOf(a)).slice(0, count);
  const efforts = named("effort");
  const resultants = named("reaction", (one) => one.name.endsWith(":resultant"));
  const chart = (names) => addCard("chart", { x: alongInstants, names });
  if (efforts.length) chart(largest(efforts, 6).sort((a, b) => efforts.indexOf(a) - efforts.indexOf(b)));
  const forces = ["bending", "axial", "shear"].flatMap((name) => sections.map((section) => [section, section.forces.get(name)]));
  const bent = forces.filter(([, force]) => force && !force.open).map(([section, force]) => [section, force, peakOf(`section:${section.link}:${force.name}`)]);
  const worst = bent.filter(([, force]) => force.name === bent[0][1].name).sort((a, b) => b[2] - a[2])[0];
  if (worst) {
    const [{ link, xi }, { name }] = worst;
    addCard("diagram", { link, when: "governs" });
    addCard("map", { link, name });
    addCard("section", { link, ratio: Math.round((rowByName.get(`section:${link}:${name}`)?.peak?.xi ?? 0.5) * (xi.length - 1)) });
  }
  const stressed = contents.maps.filter((map) => map.name.startsWith("stress:")).sort((a, b) => b.peak.value - a.peak.value)[0];
  if (stressed) addCard("map", { link: stressed.link, name: "stress" });
  if (resultants.length) chart(largest(resultants, 5));
  const joints = polarJoints();
  const turning = joints.filter((joint) => joint.kind === "revolute");
  const most = [...(turning.length ? turning : joints)].sort((a, b) => peakOf(`reaction:${b.name}:resultant`) - peakOf(`reaction:${a.name}:resultant`))[0];
  if (most) addCard("polar", { joint: most.name, way: "0" });
  const own = named("output");
  if (own.length) chart(own.slice(0, 6));
  if (!deck.cards.length) chart(named("motion").slice(0, 1));
}

/** The buttons that add cards. */
function addingBar() {
  const driven = contents.series.find((one) => one.group === "motion" && one.what === "coordinate");
  const effort = contents.series.find((one) => one.group === "effort") ?? contents.series[0];
  const section = sections.find((one) => knownForces(one).length);
  const diagrams = diagramLinks()[0];
  const joint = polarJoints()[0];
  const button = (words, add) => element("button", { type: "button", class: "add", click: add }, `+ ${words}`);
  const adds = (words, kind, chosen) => button(words, () => addCard(kind, chosen, true));
  return element(
    "div", { class: "adding", role: "group", "aria-label": "Add a plot" },
    effort && adds("chart", "chart", { x: alongInstants, names: [effort.name] }),
    effort && driven && adds("cross-plot", "chart", { x: driven.name, names: [effort.name] }),
    section && button("section", () => pinSection({ link: section.link, ratio: 50 })),
    diagrams && adds("diagrams", "diagram", { link: diagrams.link, when: "governs" }),
    section && adds("section map", "map", { link: section.link, name: knownForces(section)[0].name }),
    joint && adds("polar plot", "polar", { joint: joint.name, way: "0" }),
  );
}
