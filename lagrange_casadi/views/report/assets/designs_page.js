// The page of a sweep: conditions, maps, fronts, the table of designs, and the design that is looked at, in motion.

const MOST_ROWS = 300; // Of the table at once.

const TALLEST = 4000; // Points that the mechanism in motion may take, with what is largest in its links.

function buildSweep() {
  const root = document.getElementById("report");
  const looked = element("section", { class: "left looked-at" });
  const cards = element("div", { class: "cards" });
  root.append(sweepHead(), conditionBar(), element("div", { class: "desk" }, looked, element("div", { class: "right" }, cards)), element("div", { class: "tables" }, designTable()), tip, said);
  const plots = [mapCard(), frontCard()].filter(Boolean);
  cards.append(...plots.map((card) => card.body));
  plots.forEach((card) => card.renew());
  lookedAt(looked);
  const renew = () => plots.forEach((card) => card.draw());
  picked.watchers.add(renew);
  reading.watchers.add(renew);
  drawWith(cards, renew);
  const [first, second] = pair;
  pick(first ? frontOf(first, second ?? first)[0] ?? 0 : 0);
}

function sweepHead() {
  const { shown: many, total } = contents.designs;
  const counts = contents.counts.map(([words, count]) => `${count} ${words}`).join("; ");
  const some = many < total ? `, ${many} of them in this page: those of the front, and others evenly spread` : "";
  const described = element("p", { class: "subtitle" }, `${total} designs over ${contents.parameters.map((one) => one.name).join(", ")}: ${counts}${some}`);
  return headWith(contents.case, described, null, siSwitch(), printSwitch());
}

/** Where the reader says which designs are shown. */
function conditionBar() {
  const wrong = element("output", { class: "alarm" });
  const count = element("output", {});
  const describe = () => (count.textContent = `${picked.met.length} of ${designs.count} designs`);
  const field = element("input", { type: "search", placeholder: `conditions, as ${contents.parameters[0].name}<0.3, ${pair[0]?.name ?? contents.parameters[0].name}<=12`, "aria-label": "Conditions", input: () => {
    wrong.textContent = filter(field.value);
  } });
  picked.watchers.add(describe);
  describe();
  return element("div", { class: "conditions" }, field, count, wrong);
}

const columnEntries = () => (varying.length ? varying : columns).map((one) => [one.name, one.title]);

/** The columns that vary, peaks first, those that vary most before others. */
const ranked = varying.filter((one) => !contents.parameters.some(({ name }) => name === one.name)).sort((a, b) => b.sized - a.sized || variation(b) - variation(a));

/** The two columns of the front: the usual ones, or in the place of one that is the same for all designs another. */
const pair = [...contents.pair.map((name) => columnOf.get(name)).filter(varies), ...ranked].filter((one, k, all) => all.indexOf(one) === k).slice(0, contents.pair.length);

/** What is the same in all designs, in one line. */
function sameLine() {
  const same = columns.filter((one) => !varies(one));
  if (!same.length || designs.count < 2) return null;
  const first = status.indexOf(0);
  return element("p", { class: "fine" }, `The same in all designs: ${same.map((one) => `${one.title} ${columnWords(one, Math.max(first, 0))}`).join("; ")}.`);
}

/** A card of designs: its state has columns by their names, of which the plot is made. */
function designCard(title, state, Plot) {
  return new Card(title, state, () => new Plot(...Object.values(state).map((name) => columnOf.get(name))));
}

function mapCard() {
  const [x, y] = contents.varied;
  const column = (ranked[0] ?? contents.columns[0])?.name;
  if (!column || !x) return null;
  const card = y ? designCard("Map", { column, x, y }, DesignMap) : designCard(`Over ${x}`, { x, column }, DesignFront);
  const parameters = contents.varied.map((name) => [name, name]);
  card.choices.append(card.choose("column", "Column", columnEntries()));
  if (y) card.choices.append(element("label", {}, "over ", card.choose("x", "Across", parameters)), element("label", {}, "and ", card.choose("y", "Up", parameters)));
  return card;
}

function frontCard() {
  if (!pair.length) return null;
  const card = designCard("Front: less is better", { x: pair[0].name, y: (pair[1] ?? contents.parameters[0]).name }, DesignFront);
  card.choices.append(card.choose("y", "Up", columnEntries()), element("label", {}, "against ", card.choose("x", "Across", columnEntries())));
  return card;
}

/** The table of designs that meet the conditions. */
function designTable() {
  const parameters = varying.filter((one) => contents.parameters.some(({ name }) => name === one.name));
  const chosen = [...new Set([...parameters, ...pair, ...varying])].slice(0, 9);
  const heads = [["design", (row) => String(designs.numbers[row.at]), (row) => designs.numbers[row.at]],
    // A long name may go on in the next line, behind a colon.
    ...chosen.map((one) => [one.title.replaceAll(":", ":\u200b"), (row) => (status[row.at] && !parameters.includes(one) ? "–" : columnWords(one, row.at)), (row) => costOf(one, row.at)]),
    ["result", (row) => (status[row.at] ? contents.statuses[status[row.at]] : "ok")]];
  const plain = [["design", (row) => designs.numbers[row.at]], ...columns.map((one) => [`${one.name} [${one.unit}]`, (row) => one.values[row.at]]), ["status", (row) => status[row.at]]];
  const table = sortedTable("Designs", heads, () => picked.met.map((at) => ({ at, name: `design ${designs.numbers[at]}` })), { chosen: (row) => pick(row.at), described: "Look at this design", aside: sameLine(), plain, most: MOST_ROWS, kind: "designs" });
  let met = picked.met;
  picked.watchers.add(() => {
    if (met !== picked.met) table.fill();
    met = picked.met;
  });
  return table.body;
}

/** The design that is looked at: its numbers, the command line that evaluates it, and its mechanism in motion. */
function lookedAt(body) {
  const words = element("h3", {});
  const list = element("dl", { class: "readings" });
  const set = () => contents.parameters.map((one) => `--set ${one.name}=${columnOf.get(one.name).values[picked.row]}`);
  const copy = copyButton("copy as --set", () => [contents.command, ...set()].join(" "), "command line");
  body.append(element("header", {}, words, copy), list);
  const frame = contents.frame && element("iframe", { sandbox: "allow-scripts allow-modals allow-downloads", title: "The mechanism of the design, in motion", srcdoc: contents.frame });
  const send = () => frame?.contentWindow?.postMessage({ design: Object.fromEntries(contents.parameters.map((one) => [one.name, columnOf.get(one.name).values[picked.row]])) }, "*");
  // The page within says when its engine is ready.
  window.addEventListener("message", (event) => {
    if (!frame || event.source !== frame.contentWindow) return;
    if (event.data === "alive") send();
    else if (event.data?.height > 0) frame.style.height = `${Math.min(event.data.height, TALLEST)}px`;
  });
  body.append(frame || element("p", { class: "none" }, contents.note));
  const describe = () => {
    if (picked.row < 0) return;
    words.textContent = designWords(picked.row);
    const described = status[picked.row] ? [["no result", contents.statuses[status[picked.row]]]] : varying.filter((one) => one.name.startsWith("peak:")).map((one) => [one.title, columnWords(one, picked.row)]);
    list.replaceChildren(...described.map(([name, value]) => element("div", {}, element("dt", {}, name.replaceAll(":", ":\u200b")), element("dd", {}, value))));
    announce(words.textContent);
  };
  picked.watchers.add(describe);
  picked.watchers.add(send);
  showing(describe);
}

buildSweep();
