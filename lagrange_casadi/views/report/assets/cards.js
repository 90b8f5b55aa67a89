// The cards beside the picture: each shows what its reader chooses.

const deck = { cards: [], list: null, stage: null };

/** A card: a head with what is chosen, and a plot that is made anew when that changes. */
class Card {
  constructor(title, choices, make) {
    this.make = make;
    this.title = element("h3", {}, title);
    this.field = element("div", { class: "field" });
    this.choices = element("div", { class: "choices" });
    this.legend = element("ul", { class: "legend" });
    const close = signButton("✕", "Remove this plot", () => this.remove(), { class: "sign small" });
    this.body = element("section", { class: "card" }, element("header", {}, this.title, this.choices, saveList(this), close), this.legend, this.field);
    this.seen = true;
    // What is out of sight need not go with the motion.
    this.watcher = new IntersectionObserver(([entry]) => {
      this.seen = entry.isIntersecting;
      this.mark(player.instant);
    });
    this.watcher.observe(this.body);
    choices(this);
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
    this.plot = without ? null : this.make(this);
    const words = without ? "There is no such design." : (this.lacking?.() ?? "Nothing is chosen.");
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
        const swatch = drawn("svg", { width: 26, height: 8, "aria-hidden": "true" },
          drawn("line", { x1: 1, x2: 25, y1: 4, y2: 4, class: `curve of-${k % BODY_COLOURS}`, "stroke-dasharray": DASHES[k % DASHES.length] }));
        const drop = this.drop && signButton("✕", `Leave ${curve.title} out`, () => this.drop(k), { class: "sign tiny" });
        return element("li", {}, swatch, element("span", {}, curve.title), value, drop);
      }),
      ...(this.plot?.described?.() ?? []),
    );
  }
}

function addCard(card, focus) {
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
  const title = () => {
    const groups = [...new Set(state.names.map((name) => contents.groups[seriesByName.get(name).group]))];
    return groups.length === 1 ? groups[0] : "Chart";
  };
  const card = new Card(
    title(),
    (own) => {
      const add = chooser("Add a curve", [["", "+ curve"], ...seriesEntries()], "", (name) => {
        if (name && !state.names.includes(name)) state.names.push(name);
        add.value = "";
        own.renew();
      });
      add.classList.add("curves");
      const x = chooser("Over", axes, state.x, (name) => {
        state.x = name;
        own.renew();
      });
      own.choices.append(add, element("label", {}, "over ", x));
    },
    (own) => {
      own.title.textContent = title();
      return state.names.length ? new Chart(curveOf(state.x), state.names.map(curveOf)) : null;
    },
  );
  card.drop = (k) => {
    state.names.splice(k, 1);
    card.renew();
  };
  return addCard(card, focus);
}

/** All forces of one section over the instants. */
function sectionCard(section, ratio, focus = false) {
  const state = { section, ratio };
  const card = new Card(
    "A section",
    (own) => {
      const described = element("output", { class: "ratio" });
      const slider = element("input", {
        type: "range", min: 0, max: section.xi.length - 1, value: ratio, "aria-label": "Place along the link, ξ/l",
        input: () => own.pin({ section: state.section, ratio: Number(slider.value) }),
      });
      const link = chooser("Link", sections.map((one) => [one.link, one.link]), section.link, (name) =>
        own.pin({ section: sectionByLink.get(name), ratio: state.ratio }),
      );
      own.pin = (pinned) => {
        Object.assign(state, pinned);
        link.value = state.section.link;
        slider.value = state.ratio;
        own.renew();
        deck.stage.pinned = { section: state.section, ratio: state.ratio };
        deck.stage.draw();
      };
      own.describe = () => {
        const xi = state.section.xi[state.ratio];
        described.textContent = `ξ/l = ${format(xi, 3)}, ${shown(xi * state.section.length, "m", 4, state.section.length)} from the base`;
      };
      own.choices.append(link, slider, described);
    },
    (own) => {
      own.describe();
      const forces = knownForces(state.section).filter((force) => !contents.space || ["axial", "shear", "torsion", "bending"].includes(force.name));
      return forces.length ? new Chart(curveOf(alongInstants), forces.map((force) => curveOfSection(state.section, force, state.ratio))) : null;
    },
  );
  card.ofSection = true;
  return addCard(card, focus);
}

/** Show the section of a link at a ratio. */
function showSection(link, xi) {
  const section = sectionByLink.get(link);
  pinSection({ section, ratio: Math.round(xi * (section.xi.length - 1)) }, false);
}

/** Pin a section: the card of sections shows it, and the picture marks it. */
function pinSection(pinned, focus = true) {
  const card = deck.cards.find((one) => one.ofSection) ?? sectionCard(pinned.section, pinned.ratio, focus);
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
  const card = new Card(
    "Section map",
    (own) => {
      const what = element("span");
      const offer = () =>
        what.replaceChildren(
          chooser("What is mapped", mappedOf(state.link).map((one) => [one.name, one.what]), state.name, (name) => {
            state.name = name;
            own.renew();
          }),
        );
      const known = sections.filter((one) => knownForces(one).length).map((one) => [one.link, one.link]);
      const links = chooser("Link", known, link, (name) => {
        state.link = name;
        if (!chosen()) state.name = mappedOf(name)[0].name;
        offer();
        own.renew();
      });
      offer();
      own.choices.append(links, what);
      own.lacking = () => "This map shows the file's design only; charts and peaks of stresses follow the sliders.";
    },
    () => {
      const one = chosen();
      return one.ofFile && designState() !== "file" ? null : new Heat(one.field());
    },
  );
  return addCard(card, focus);
}

/** N, V and M along a link, at the instant that governs it or at that which is shown. */
function diagramCard(link, focus = false) {
  const state = { link, when: "governs" };
  const card = new Card(
    "Diagrams",
    (own) => {
      const choose = (key, label, entries) => chooser(label, entries, state[key], (value) => {
        state[key] = value;
        own.renew();
      });
      own.choices.append(
        choose("link", "Link", diagramLinks().map((one) => [one.link, one.link])),
        choose("when", "Instant", [["governs", "at the instant that governs"], ["shown", "at the instant shown"]]),
      );
    },
    () => new Diagram(sectionByLink.get(state.link), state.when),
  );
  return addCard(card, focus);
}

function polarCard(joint, focus = false) {
  const state = { joint, way: 0 };
  const card = new Card(
    "Bearing load",
    (own) => {
      const ways = element("span");
      const offer = () =>
        ways.replaceChildren(
          chooser("Axes", polarWays(state.joint).map((way, k) => [String(k), way.words]), String(state.way), (value) => {
            state.way = Number(value);
            own.renew();
          }),
        );
      const joints = chooser("Joint", polarJoints().map((one) => [one.name, one.name]), joint.name, (name) => {
        state.joint = contents.joints.find((one) => one.name === name);
        state.way = 0;
        offer();
        own.renew();
      });
      offer();
      own.choices.append(joints, ways);
    },
    () => new Polar(state.joint, polarWays(state.joint)[state.way] ?? polarWays(state.joint)[0]),
  );
  return addCard(card, focus);
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
