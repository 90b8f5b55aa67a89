// The page: its head, the picture with what it shows, the cards, the tables; light and dark, units, print.

function buildPage() {
  const canvas = element("canvas", { class: "picture", tabindex: 0, role: "img", "aria-label": `The mechanism ${contents.case} in motion` });
  const root = document.getElementById("report");
  root.classList.toggle("within", together || (window.parent !== window && Boolean(contents.live)));
  deck.list = element("div", { class: "cards" });
  const frame = element("div", { class: "frame" }, canvas);
  const left = element("div", { class: "left" }, frame);
  root.append(
    element("a", { class: "skip", href: "#tables" }, "Skip to the tables"), headOf(), glanceOf(), element("div", { class: "desk" }, left, element("div", { class: "right" }, linksTable(), deck.list, addingBar())),
    element("div", { class: "tables", id: "tables" }, strengthTables(), driveTables(), resultTables(showRow)), element("div", { class: "facts" }, factSections()), tip, said,
  );
  const stage = new Stage(canvas);
  deck.stage = stage;
  listenTo(stage, { point: (found, event) => pointAt(stage, found, event), pin: pinSection });
  frame.append(viewBar(stage));
  left.append(transportBar(), showBar(stage));
  if (contents.live) {
    const panel = element("section", { class: "alive", "aria-label": "Parameters" });
    frame.before(panel);
    comeAlive(panel, stage);
  }
  stage.layOut();
  firstCards();
  watch(stage, canvas);
  player.seek(0);
  if (together) goTogether();
  if (!window.matchMedia("(prefers-reduced-motion: reduce)").matches && window.name !== "run 2") player.play();
}

/** Where the picture is now, by the clock of both runs. */
const placeNow = () => [player.time, over && array(over.values)[player.instant]];

/** Go to a place of the clock of both runs. */
function goTo([time, value]) {
  if (clock.name === "over") player.seek(nearest(array(over.values), value));
  else player.seek(instantAt(time), time);
}

/** Show the instant of the clock of both runs: send it to the other, and go where the other says. */
function goTogether() {
  let following = false;
  player.watchers.add(() => {
    if (following) return;
    motion.began = player.playing ? motion.began ?? placeNow() : null;
    post("follow", [placeNow(), motion.began]);
  });
  acts.follow = (place, began) => {
    following = true;
    motion.began = began;
    player.pause();
    goTo(place);
    following = false;
  };
  acts.pause = () => player.pause();
  acts.si = setSi;
}

/** The name, what was evaluated, whether it was certified, and the switches. */
function headOf() {
  const states = {
    certified: [forcesChecked ? "✓ certified" : "✓ motion certified", "certified"], failed: ["✗ the certificate fails", "failed"], none: ["no certificate", "none"],
    other: ["another design, not certified", "doubt"], impossible: ["no such design", "failed"],
  };
  const badge = element("span");
  const verdict = () => {
    const [words, kind] = states[{ file: contents.certificate.state, other: "other", none: "impossible" }[designState()]];
    badge.className = `badge ${kind}`;
    say(badge, words);
  };
  showing(verdict);
  const shownOf = instants.count < instants.total ? `, ${instants.count} of them shown` : "";
  const span = () => `${instants.total} instant${instants.total > 1 ? "s" : ""}${shownOf}, t = ${[0, -1].map((k) => timeWords(instants.t.at(k))).join(" to ")}`;
  const described = element("p", { class: "subtitle" });
  showing(() => say(described, span()));
  const next = { auto: "light", light: "dark", dark: "auto" };
  const { dataset } = document.documentElement;
  dataset.theme ??= "auto";
  const theme = switchButton(`◐ ${dataset.theme}`, "Light or dark", () => {
    dataset.theme = next[dataset.theme];
    theme.textContent = `◐ ${dataset.theme}`;
    repaint();
  });
  return headWith(contents.case, described, badge, siSwitch(), theme, printSwitch());
}

/** What is largest, at a glance: press one to see when and where it is. */
function glanceOf() {
  const groups = [["effort", ""], ["reaction", ":resultant"], ["section", ":axial"], ["section", ":shear"], ["section", ":bending"], ["stress", ""]];
  const tiles = groups.flatMap(([group, ending]) => {
    const rows = contents.rows.filter((row) => row.group === group && !row.open && row.name.endsWith(ending));
    if (!rows.length) return [];
    const largest = () => rows.reduce((best, row) => (Math.abs(row.peak.value) > Math.abs(best.peak.value) ? row : best));
    const [what, value, where] = [element("span", { class: "what" }), element("b"), element("span", { class: "where" })];
    showing(() => {
      const row = largest();
      const xi = row.peak.xi === null ? "" : ` · ξ/l = ${row.peak.xi.toFixed(2)}`;
      const known = Number.isFinite(row.peak.value);
      say(what, `Largest ${row.what.replace("resultant ", "")}`);
      say(value, peakWords(row));
      say(where, isNothing(row) ? "" : known ? `${row.part}${xi} · ${whenOf(row.peak.t, row.peak.over)}` : "no result");
    });
    return [element("button", { type: "button", class: "tile", title: "Show when and where", click: () => showRow(largest()) }, what, value, where)];
  });
  return element("div", { class: "glance" }, tiles);
}

/** What is largest in each link, with when it is: a row a link, a button a force; nothing where no link has sections. */
function linksTable() {
  const names = ["axial", "shear", "torsion", "bending"];
  const rowsOf = (link) => [...names.map((name) => rowByName.get(`section:${link}:${name}`)), rowByName.get(`stress:${link}:von_mises`)];
  const links = contents.sections.map((entry) => [entry.link, rowsOf(entry.link)]);
  const columns = [0, 1, 2, 3, 4].filter((k) => links.some(([, rows]) => rows[k]));
  if (!columns.length) return null;
  const cellOf = (row) => {
    if (!row || row.open) return element("td", {}, row ? "indeterminate" : "");
    const [value, when] = [element("b"), element("small")];
    showing(() => {
      const { peak } = row;
      say(value, peakWords(row));
      say(when, !Number.isFinite(peak.value) || isNothing(row) ? "" : over ? shown(peak.over, over.unit, 4) : whenOf(peak.t, null));
    });
    return element("td", {}, element("button", { type: "button", title: "Show when and where", click: () => showRow(row) }, value, when));
  };
  const heads = columns.map((k) => element("th", { scope: "col" }, links.map(([, rows]) => rows[k]).find(Boolean).what.replace("resultant ", "")));
  const lines = links.map(([link, rows]) => element("tr", {}, element("th", { scope: "row" }, link), columns.map((k) => cellOf(rows[k]))));
  return element("section", { class: "card links" }, element("header", {}, element("h3", {}, "Largest in each link"), over && element("span", { class: "fine" }, `with the ${over.unit === "rad" ? "angle" : "place"} of ${over.joint}`)),
    element("div", { class: "scroll" }, element("table", { "aria-label": "Largest in each link" }, element("thead", {}, element("tr", {}, element("th", { scope: "col" }, "link"), heads)), element("tbody", {}, lines))));
}

/** Show when a row peaks; of a section force also where, with its ribbon. */
function showRow(row) {
  seekTo(instantAt(row.peak.t));
  if (row.group === "section") {
    deck.stage.show("ribbon", row.name.slice(`section:${row.part}:`.length));
    showSection(row.part, row.peak.xi);
  }
  deck.stage.paper.canvas.scrollIntoView({ block: "nearest", behavior: "smooth" });
  announce(`${titleOf(row)}: ${shown(row.peak.value, row.unit)}, ${whenOf(row.peak.t, row.peak.over)}`);
}

function pointAt(stage, found, event) {
  const { pointed } = stage;
  stage.pointed = found;
  const same = found?.link === pointed?.link && found?.ratio === pointed?.ratio;
  if (!same && !player.playing) stage.draw();
  if (found) showTip(event, placeWords(found), sectionLines(found, stage.instant));
  else showTip(null);
}

function viewBar(stage) {
  return element("div", { class: "views", role: "group", "aria-label": "View" },
    VIEWS.map(([key, words, angles]) => element("button", { type: "button", title: `${words} (${key})`, click: () => stage.view(...angles) }, words)),
    signButton("+", "Nearer (+)", () => stage.zoom(1.25)),
    signButton("−", "Farther (-)", () => stage.zoom(0.8)),
    element("button", { type: "button", title: "All of it (F, or a double click)", click: () => stage.fit() }, "Fit"));
}

/** What is shown on the mechanism: arrows, ribbons, names. */
function showBar(stage) {
  const box = (what, words) => {
    const field = element("input", { type: "checkbox", checked: stage.shows[what], change: () => stage.show(what, field.checked) });
    stage.controls[what] = (value) => { field.checked = value; };
    return element("label", { class: `show ${what}` }, field, ` ${words}`);
  };
  const kinds = Object.entries(KINDS).filter(([kind]) => actions.some((action) => action.kind === kind));
  const ribbons = ribbonForces.length > 0 && chooser("Section force along links", [...ribbonForces.map((force) => [force.name, force.what]), ["", "no section force"]], stage.shows.ribbon, (name) => stage.show("ribbon", name));
  if (ribbons) {
    ribbons.classList.add("ribbon");
    stage.controls.ribbon = (name) => { ribbons.value = name; };
  }
  const size = element("input", { type: "range", min: -1.5, max: 1.5, step: 0.05, value: 0, class: "size", "aria-label": "Length of arrows and ribbons", input: () => stage.show("size", 2 ** Number(size.value)) });
  stage.controls.size = (value) => { size.value = Math.log2(value); };
  const signs = element("span", { class: "signs" }, element("i", { class: "positive" }), " + ", element("i", { class: "negative" }), " −");
  return element("div", { class: "shows", role: "group", "aria-label": "Shown on the mechanism" },
    ribbons, ribbons && signs, kinds.map(([kind, words]) => box(kind, words)), box("values", "values"), box("names", "names"), contents.paths.length > 0 && box("traces", "paths"), box("ways", "joints' paths"),
    (kinds.length > 0 || ribbons) && element("label", { class: "scale" }, "scale ", size));
}

/** Draw all anew, in the colours that the page has now. */
function repaint() {
  deck.stage.layOut();
  for (const card of deck.cards) card.draw();
}

function watch(stage, canvas) {
  let spoken = 0;
  player.watchers.add((instant) => {
    stage.draw(instant);
    for (const card of deck.cards) card.mark(instant);
    if (!player.playing && performance.now() - spoken > 300) {
      spoken = performance.now();
      canvas.setAttribute("aria-label", `The mechanism ${contents.case} at ${whenIs(instant)}`);
    }
  });
  reading.watchers.add(() => {
    stage.draw();
    for (const card of deck.cards) card.follow();
  });
  // The sheet's size goes with the window's height too, and with the controls below it.
  new ResizeObserver(() => canvas.isConnected && stage.layOut()).observe(canvas);
  drawWith(deck.list, repaint);
  listenToKeys(stage);
  listenToPrinter(stage);
}

/** On paper: light, still, and as sharp as the printer. */
function listenToPrinter(stage) {
  let before;
  window.addEventListener("beforeprint", () => {
    before = { theme: document.documentElement.dataset.theme, playing: player.playing };
    const { began } = motion;
    player.pause();
    if (began) goTo(began);
    document.documentElement.dataset.theme = "light";
    stage.paper.readInks();
    // Two pictures side by side are each half as wide, with letters of the same size.
    stage.paper.resize(together ? 530 : 1060, together ? 280 : 560, 3);
    if (!stage.touched) stage.place();
    stage.draw();
    for (const card of deck.cards) {
      card.seen = true;
      card.draw();
    }
  }, { signal: ended.signal });
  window.addEventListener("afterprint", () => {
    if (!before) return;
    document.documentElement.dataset.theme = before.theme;
    repaint();
    if (before.playing) player.play();
  }, { signal: ended.signal });
}

buildPage();
