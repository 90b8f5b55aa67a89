// The page of two runs: what is largest in each, their curves in one chart, and both mechanisms in motion side by side.

const runs = contents.runs.map((run) => ({ ...run, seriesByName: new Map(run.series.map((one) => [one.name, one])) }));

/** Quantities that both have, in the order of the first. */
const shared = runs[0].series.filter((one) => runs[1].seriesByName.get(one.name)?.unit === one.unit);

const titleOf = (one) => (one.part && one.what ? `${one.part}: ${one.what}` : one.part || one.what);

/** How the instants of both are shown: over the drive where both are asked for over the same joint, else over time. */
const along = runs.map((run) => (contents.clock.name === "over" ? { name: "over", title: run.over.joint, unit: run.over.unit, values: array(run.over.values) } : { name: "t", title: "time", unit: "s", values: array(run.t) }));

function buildComparison() {
  const root = document.getElementById("report");
  const cards = firstNames().map((name) => new Comparison(name));
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
  let width = 0;
  new ResizeObserver(() => {
    if (root.clientWidth === width) return;
    width = root.clientWidth;
    renew();
  }).observe(root);
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", renew);
  window.addEventListener("beforeprint", () => {
    document.documentElement.dataset.theme = "light";
    cards.forEach((card) => card.draw(330));
  });
  window.addEventListener("afterprint", () => {
    delete document.documentElement.dataset.theme;
    renew();
  });
}

/** The line by which a run is drawn: the second one is dashed, so that both are distinguished without colours. */
function swatch(k) {
  return drawn("svg", { width: 26, height: 8, "aria-hidden": "true" }, drawn("line", { x1: 1, x2: 25, y1: 4, y2: 4, class: `curve of-${k}`, "stroke-dasharray": k ? "7 3" : "" }));
}

function headOf(send) {
  const si = element("button", { type: "button", class: "switch", "aria-pressed": "false", title: "Units of the file: SI, without prefixes", click: () => {
    setSi(!reading.si);
    si.setAttribute("aria-pressed", String(reading.si));
    send({ act: "si", given: [reading.si] });
  } }, "SI units");
  const names = runs.map((run, k) => element("span", { class: "run" }, swatch(k), ` ${run.name}${run.certified ? "" : ", not certified"}`));
  return element("header", { class: "head" },
    element("div", {}, element("h1", {}, `${contents.case}: two runs`), element("p", { class: "subtitle" }, names),
      contents.same && element("p", { class: "alarm" }, "Both runs are the same: all their values are equal.")),
    element("div", { class: "switches" }, si, element("button", { type: "button", class: "switch", click: () => {
      // Both pictures are at rest, and at the same time, before they are printed.
      send({ act: "pause", given: [] });
      setTimeout(() => window.print(), 200);
    } }, "Print")));
}

/** The quantities that are charted first: the largest effort, reaction and section forces. */
function firstNames() {
  const most = (filter) => contents.rows.filter((row) => shared.some((one) => one.name === row.name) && filter(row)).sort((a, b) => Math.max(...b.values.map(Math.abs)) - Math.max(...a.values.map(Math.abs)))[0]?.name;
  const names = [(row) => row.group === "effort", (row) => row.name.endsWith(":resultant"), (row) => row.name.startsWith("section:") && row.name.endsWith(":bending"), (row) => row.name.startsWith("section:") && row.name.endsWith(":axial")].map(most);
  const found = names.filter(Boolean);
  return found.length ? found : shared.slice(0, 1).map((one) => one.name);
}

/** A chart of one quantity of both runs. */
class Comparison {
  constructor(name) {
    this.name = name;
    this.title = element("h3", {}, "");
    this.field = element("div", { class: "field" });
    this.legend = element("ul", { class: "legend" }, runs.map((run, k) => element("li", {}, swatch(k), element("span", {}, run.name))));
    const groups = Object.entries(contents.groups).map(([group, head]) => [head, shared.filter((one) => one.group === group).map((one) => [one.name, titleOf(one)])]).filter(([, entries]) => entries.length);
    const list = chooser("Quantity", groups, name, (chosen) => {
      this.name = chosen;
      this.draw();
    });
    this.choices = element("div", { class: "choices" }, list);
    this.plot = this;
    this.body = element("section", { class: "card" }, element("header", {}, this.title, this.choices, saveList(this)), this.legend, this.field);
    this.sheet = new Sheet("curves", "", { hover: (event) => this.hover(event), press: () => {} });
    this.field.append(this.sheet.body);
  }

  draw(width = this.field.clientWidth) {
    if (!width) return;
    this.curves = runs.map((run) => array(run.seriesByName.get(this.name).values));
    const { unit } = runs[0].seriesByName.get(this.name);
    this.title.textContent = titleOf(runs[0].seriesByName.get(this.name));
    this.sheet.body.setAttribute("aria-label", `${this.title.textContent} of both runs, over ${along[0].title}`);
    const [left, right, top, height] = [62, 14, 20, 240];
    this.across = scaled(endsOf(along.map(({ values }) => values), false), [left, width - right], along[0].unit, along[0].title);
    this.up = scaled(endsOf(this.curves, true), [height - 40, top], unit, "", 0.06);
    this.sheet.fill(width, height, axesOf(this.across, this.up),
      drawn("text", { x: left - 7, y: top - 7, class: "unit" }, this.up.unit || "1"),
      drawn("text", { x: (left + width - right) / 2, y: height - 6, class: "label" }, this.across.label),
      ...this.curves.map((values, k) => drawn("path", { d: pathOf(along[k].values, values, this.across, this.up, 0.5), class: `curve of-${k}`, "stroke-dasharray": k ? "7 3" : "" })));
  }

  hover(event) {
    if (!event) {
      this.sheet.pointer.replaceChildren();
      showTip(null);
      return;
    }
    const x = this.across.back(this.sheet.at(event)[0]);
    const { unit } = runs[0].seriesByName.get(this.name);
    const most = Math.max(...this.curves.map(largestOf));
    const at = along.map(({ values }) => nearest(values, x));
    this.sheet.pointer.replaceChildren(...at.map((i, k) => drawn("circle", { cx: this.across.at(along[k].values[i]), cy: this.up.at(this.curves[k][i]), r: 3.6, class: `of-${k}` })));
    showTip(event, `${along[0].title} = ${shown(along[0].values[at[0]], along[0].unit)}`, runs.map((run, k) => [run.name, shownOf(this.curves[k][at[k]], unit, most)]));
  }

  /** What is saved as CSV: both runs below each other, for their instants may differ. */
  table() {
    const { unit } = runs[0].seriesByName.get(this.name);
    return { heads: ["run", `${along[0].name === "t" ? "t" : along[0].title} [${along[0].unit}]`, `${this.name} [${unit}]`], rows: runs.flatMap((run, k) => Array.from(this.curves[k], (value, i) => [k + 1, along[k].values[i], value])) };
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
  const table = sortedTable("Largest in both", heads, () => rows, { plain });
  table.body.classList.add("compared");
  return table.body;
}

/** The parameters of both; those that differ first. */
function parameterTable() {
  const names = [...new Set(runs.flatMap((run) => Object.keys(run.parameters)))];
  if (!names.length) return null;
  const value = (name, k) => (runs[k].parameters[name] ? shown(...runs[k].parameters[name], 7) : "");
  const differs = (name) => runs[0].parameters[name]?.[0] !== runs[1].parameters[name]?.[0];
  const rows = names.map((name) => ({ name })).sort((a, b) => differs(b.name) - differs(a.name));
  const heads = [["parameter", (row) => row.name], ...runs.map((run, k) => [run.name, (row) => value(row.name, k)]), ["", (row) => (differs(row.name) ? "differs" : "")]];
  const table = sortedTable("Parameters", heads, () => rows);
  table.body.classList.add("compared");
  return table.body;
}

buildComparison();
