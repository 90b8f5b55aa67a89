// The page of two runs: what is largest in each, their curves in one chart, and both mechanisms in motion side by side.

const runs = contents.runs.map((run) => ({ ...run, seriesByName: new Map(run.series.map((one) => [one.name, one])) }));

/** Quantities that both have, in the order of the first. */
const shared = runs[0].series.filter((one) => runs[1].seriesByName.get(one.name)?.unit === one.unit);

/** How the instants of both are shown: over the drive where both are asked for over the same joint, else over time. */
const along = runs.map((run) => (contents.clock.name === "over" ? { name: "over", title: run.over.joint, unit: run.over.unit, values: array(run.over.values) } : { name: "t", title: "time", unit: "s", values: array(run.t) }));

function buildComparison() {
  const root = document.getElementById("report");
  const cards = firstNames().map(comparisonCard);
  const frames = runs.map((run, k) => element("section", { class: "left looked-at" },
    element("header", {}, swatch(k), element("h3", {}, run.name)),
    element("iframe", { name: `run ${k + 1}`, sandbox: "allow-scripts allow-modals allow-downloads", title: `${run.name}, in motion`, srcdoc: run.frame })));
  window.addEventListener("message", (event) => {
    const from = frames.findIndex((frame) => frame.lastChild.contentWindow === event.source);
    if (from >= 0) frames[1 - from].lastChild.contentWindow.postMessage(event.data, "*");
  });
  const send = (data) => frames.forEach((frame) => frame.lastChild.contentWindow.postMessage(data, "*"));
  root.append(headOf(send), element("div", { class: "beside" }, frames), element("div", { class: "cards beside" }, cards.map((card) => card.body)),
    element("div", { class: "tables" }, largestTable(), parameterTable()), tip, said);
  const renew = () => cards.forEach((card) => card.draw());
  reading.watchers.add(renew);
  drawWith(root, renew);
  window.addEventListener("beforeprint", () => cards.forEach((card) => card.draw(330)));
  window.addEventListener("afterprint", renew);
}

function headOf(send) {
  const names = runs.map((run, k) => element("span", { class: "run" }, swatch(k), ` ${run.name}${run.certified ? "" : ", not certified"}`));
  const same = contents.same && element("p", { class: "alarm" }, "Both runs are the same: all their values are equal.");
  const si = siSwitch(() => send({ act: "si", given: [reading.si] }));
  const print = printSwitch(() => {
    // Both pictures are at rest, and at the same time, before they are printed.
    send({ act: "pause", given: [] });
    setTimeout(() => window.print(), 200);
  });
  return headWith(`${contents.case}: two runs`, [element("p", { class: "subtitle" }, names), same], null, si, print);
}

/** The quantities that are charted first: the largest effort, reaction and section forces. */
function firstNames() {
  const most = (filter) => contents.rows.filter((row) => shared.some((one) => one.name === row.name) && filter(row)).sort((a, b) => Math.max(...b.values.map(Math.abs)) - Math.max(...a.values.map(Math.abs)))[0]?.name;
  const names = [(row) => row.group === "effort", (row) => row.name.endsWith(":resultant"), (row) => row.name.startsWith("section:") && row.name.endsWith(":bending"), (row) => row.name.startsWith("section:") && row.name.endsWith(":axial")].map(most);
  const found = names.filter(Boolean);
  return found.length ? found : shared.slice(0, 1).map((one) => one.name);
}

/** A card with a chart of one quantity of both runs. */
function comparisonCard(name) {
  const card = new Card("", { name }, () => {
    const plot = new Comparison(card.state.name);
    card.title.textContent = plot.title;
    return plot;
  });
  card.legend = element("ul", { class: "legend" }, runs.map((run, k) => element("li", {}, swatch(k), element("span", {}, run.name))));
  card.field.before(card.legend);
  card.choices.append(card.choose("name", "Quantity", seriesEntries(shared)));
  card.head.append(saveList(card));
  card.renew();
  return card;
}

/** A chart of one quantity of both runs. */
class Comparison {
  constructor(name) {
    const series = runs.map((run) => run.seriesByName.get(name));
    Object.assign(this, { name, title: titleOf(series[0]), unit: series[0].unit, curves: series.map((one) => array(one.values)) });
    this.sheet = new Sheet("curves", `${this.title} of both runs, over ${along[0].title}`, this);
  }

  draw(width) {
    const height = 240;
    this.across = scaled(endsOf(...along.map(({ values }) => values)), [FIELD.left, width - FIELD.right], along[0].unit, along[0].title);
    this.up = scaled(endsOf([0], ...this.curves), [height - FIELD.bottom, FIELD.top], this.unit, "", 0.06);
    this.sheet.fill(width, height, axesOf(this.across, this.up),
      ...this.curves.map((values, k) => drawn("path", { d: pathOf(along[k].values, values, this.across, this.up, 0.5), ...lineOf(k) })));
  }

  /** The instant of each run under the pointer. */
  under(event) {
    const x = this.across.back(this.sheet.at(event)[0]);
    return along.map(({ values }) => nearest(values, x));
  }

  point(at) {
    this.sheet.pointer.replaceChildren(...at.map((i, k) => drawn("circle", { cx: this.across.at(along[k].values[i]), cy: this.up.at(this.curves[k][i]), r: 3.6, class: `of-${k}` })));
  }

  describe(at) {
    const most = Math.max(...this.curves.map(largestOf));
    return [`${along[0].title} = ${shown(along[0].values[at[0]], along[0].unit)}`, runs.map((run, k) => [run.name, shown(this.curves[k][at[k]], this.unit, 5, most)])];
  }

  /** What is saved as CSV: both runs below each other, for their instants may differ. */
  table() {
    return { heads: ["run", `${along[0].name === "t" ? "t" : along[0].title} [${along[0].unit}]`, `${this.name} [${this.unit}]`], rows: runs.flatMap((run, k) => Array.from(this.curves[k], (value, i) => [k + 1, along[k].values[i], value])) };
  }
}

/** What is largest in both, and how much the second differs. */
function largestTable() {
  const size = (row) => Math.max(...row.values.map(Math.abs));
  const nothing = (row) => row.values.every((value, k) => Math.abs(value) <= 2 * (row.errors[k] ?? 0));
  const value = (row, k) => shown(row.values[k], row.unit, 5, size(row));
  const change = (row) => 100 * (Math.abs(row.values[1]) / Math.abs(row.values[0]) - 1);
  const words = (row) => {
    const part = change(row);
    return !Number.isFinite(part) ? "–" : `${part > 0 ? "+" : ""}${format(Math.abs(part) < 1e-6 ? 0 : part, 3)}\u00a0%`;
  };
  const rows = contents.rows.filter((row) => !nothing(row));
  const heads = [
    ["part", (row) => row.part],
    ["largest in size of", (row) => row.what || row.part],
    ...runs.map((run, k) => [run.name, (row) => value(row, k), (row) => Math.abs(row.values[k])]),
    ["change", words, change],
  ];
  const plain = [["name", (row) => row.name], ["unit", (row) => row.unit], ...runs.flatMap((run, k) => [[run.name, (row) => row.values[k]], [`t [s] of ${run.name}`, (row) => row.t[k]], [`xi/l of ${run.name}`, (row) => row.xi[k]]])];
  return sortedTable("Largest in both", heads, () => rows, { plain, kind: "compared" }).body;
}

/** The parameters of both; those that differ first. */
function parameterTable() {
  const names = [...new Set(runs.flatMap((run) => Object.keys(run.parameters)))];
  if (!names.length) return null;
  const value = (name, k) => (runs[k].parameters[name] ? shown(...runs[k].parameters[name], 7) : "");
  const differs = (name) => runs[0].parameters[name]?.[0] !== runs[1].parameters[name]?.[0];
  const rows = names.map((name) => ({ name })).sort((a, b) => differs(b.name) - differs(a.name));
  const heads = [["parameter", (row) => row.name], ...runs.map((run, k) => [run.name, (row) => value(row.name, k)]), ["", (row) => (differs(row.name) ? "differs" : "")]];
  return sortedTable("Parameters", heads, () => rows, { kind: "compared" }).body;
}

buildComparison();
