// The tables of a report, and what else is said in words.

/** The largest size of each unit. */
function sizesOfUnits() {
  return once(contents.rows, (rows) => {
    const sizes = new Map();
    for (const row of rows) if (!row.open) sizes.set(row.unit, Math.max(sizes.get(row.unit) ?? 0, Math.abs(row.peak.value)));
    return sizes;
  });
}

/** Whether a quantity is nothing but rounding: by its error, or beside the largest of its unit. */
function isNothing(row) {
  return !row.open && Math.abs(row.peak.value) <= Math.max(2 * (row.error ?? 0), UNSEEN * sizesOfUnits().get(row.unit));
}

/** A peak in words; nothing is 0. */
function peakWords(row) {
  if (!Number.isFinite(row.peak.value)) return "–";
  return isNothing(row) ? shown(0, row.unit) : shown(row.peak.value, row.unit, 4);
}

/** A value of a curve with its unit, by the largest of all; the rounding of nothing, also beside the largest of the unit, is nothing. */
function shownOf(value, unit, most) {
  const nothing = Math.abs(value) <= UNSEEN * Math.max(most, sizesOfUnits().get(unit) ?? 0);
  return nothing ? shown(0, unit) : shown(value, unit, 5, most);
}

const whatOf = (row) => row.what || row.part;

/** The two large tables: peaks, and what quantities are over the cycle. */
function resultTables(show) {
  const state = { all: false, words: [] };
  const nothing = contents.rows.filter((row) => isNothing(row)).length;
  const rows = () =>
    contents.rows.filter((row) => !row.open && (state.all || !isNothing(row)) && state.words.every((word) => `${row.name} ${row.what}`.toLowerCase().includes(word)));
  const tables = [];
  const renew = () => tables.forEach((table) => table.fill());
  const find = element("input", { type: "search", placeholder: "search, for example: rod bending", "aria-label": "Find a part or quantity", class: "find", title: "Find (/); Enter shows the first that is found", input: () => {
    state.words = find.value.toLowerCase().split(/\s+/).filter(Boolean);
    renew();
  }, keydown: (event) => {
    const [first] = rows();
    if (event.key === "Enter" && first) show(first);
  } });
  const also = nothing > 0 && element("label", {}, element("input", { type: "checkbox", change: (event) => {
    state.all = event.target.checked;
    renew();
  } }), ` also what is zero (${nothing})`);
  const value = (one, row) => {
    if (one === null || one === undefined) return "";
    const size = Math.abs(row.peak.value);
    const rounding = (state.all && isNothing(row)) || Math.abs(one) <= Math.max(UNSEEN * size, row.error ?? 0);
    return Number.isNaN(one) ? "–" : rounding ? shown(0, row.unit) : shown(one, row.unit, 6, size);
  };
  const when = (mark) => (mark && !Number.isNaN(mark.t) ? timeWords(mark.t) : "");
  const names = [["name", (row) => row.name], ["part", (row) => row.part], ["quantity", whatOf], ["unit", (row) => row.unit]];
  const driveHead = over && [`${over.joint} [${over.unit}]`, (row) => row.peak.over];
  const drive = over ? [[over.joint, (row) => shown(row.peak.over, over.unit), (row) => row.peak.over]] : [];
  const error = (row) => (row.error === null ? "" : `± ${shown(row.error, row.unit, 1, Math.abs(row.peak.value))}`);
  tables.push(
    sortedTable(
      "Peaks",
      [
        ["part", (row) => row.part],
        ["quantity", whatOf],
        ["largest in size", (row) => value(row.peak.value, row), (row) => Math.abs(row.peak.value)],
        ["may be off by", error, (row) => row.error ?? -1],
        ...drive,
        ["t", (row) => when(row.peak), (row) => row.peak.t],
        ["ξ/l", (row) => (row.peak.xi === null || Number.isNaN(row.peak.xi) ? "" : row.peak.xi.toFixed(3)), (row) => row.peak.xi ?? -1],
      ],
      rows,
      {
        chosen: show,
        aside: element("div", { class: "tools" }, find, also, element("span", { class: "fine" }, "of all instants; between two of them a value may be larger")),
        plain: [...names, ["largest in size", (row) => row.peak.value], ["may be off by", (row) => row.error], ...(over ? [driveHead] : []), ["t [s]", (row) => row.peak.t], ["xi/l", (row) => row.peak.xi]],
      },
    ),
    sortedTable(
      "Over the cycle",
      [
        ["part", (row) => row.part],
        ["quantity", whatOf],
        ...["smallest", "largest"].flatMap((end) => [
          [end, (row) => value(row[end].value, row), (row) => row[end].value],
          ["at t", (row) => when(row[end]), (row) => row[end].t],
        ]),
        ...["mean", "rms"].map((kind) => [kind, (row) => value(row[kind], row), (row) => row[kind] ?? -Infinity]),
      ],
      rows,
      {
        plain: [...names, ["smallest", (row) => row.smallest.value], ["at t [s]", (row) => row.smallest.t], ["largest", (row) => row.largest.value], ["at t [s]", (row) => row.largest.t], ["mean", (row) => row.mean], ["rms", (row) => row.rms]],
      },
    ),
  );
  return tables.map((table) => table.body);
}

/** How far each part is used, and what governs: of links that have a beam, of joints with pins or bearings. */
function strengthTables() {
  if (!contents.strength.length) return [];
  const ofFile = element("span", { class: "alarm" }, "of the file's design");
  showing(() => (ofFile.hidden = designState() === "file"));
  // What is open comes last.
  const used = (row) => (row.open ? -1 : row.used ?? Infinity);
  const words = (row) => (row.open ? "" : row.used === null ? "∞" : format(row.used, 4));
  const factor = (row) => (row.open ? "not evaluated" : row.factor === null ? (row.used === 0 ? "∞" : "0") : format(row.factor, 4));
  const heads = [
    ["part", (row) => row.part],
    ["against", (row) => row.against],
    ["factor of safety", factor, (row) => (row.open ? Infinity : 1 / used(row))],
    ["utilisation", (row) => `${words(row)}${used(row) > 1 ? ", FAILS" : row.governs ? ", governs" : ""}`, used],
    ["where", (row) => row.where],
  ];
  const plain = [["part", (row) => row.part], ["against", (row) => row.against], ["factor", (row) => row.factor], ["utilisation", (row) => row.used], ["where", (row) => row.where]];
  return [sortedTable("Strength", heads, () => contents.strength, { aside: ofFile, plain }).body];
}

/** What is used of the efforts and speeds that drives can do. */
function driveTables() {
  if (!contents.drives.length) return [];
  const share = (use) => (use ? use.value / use.limit : -1);
  const words = (use) => (use ? `${format(100 * share(use), 3)} % of ${shown(use.limit, use.unit)}${share(use) > 1 ? ", EXCEEDED" : ""}` : "");
  const heads = [["drive", (row) => row.name], ...["effort", "speed"].map((word) => [`${word} used`, (row) => words(row[word]), (row) => share(row[word])])];
  const plain = [["drive", (row) => row.name], ...["effort", "speed"].flatMap((word) => [[`${word} used`, (row) => row[word] && share(row[word])], [`largest ${word}`, (row) => row[word]?.value]])];
  return [sortedTable("Drives", heads, () => contents.drives, { aside: element("span", { class: "fine" }, "of all instants of the file's design"), plain }).body];
}

/** The smaller tables and texts: parameters, parts, the certificate, what is open, how the numbers were made. */
function factSections() {
  const range = ({ low, high, unit }) => (low === null && high === null ? "" : `${low === null ? "−∞" : shown(low, unit)} to ${high === null ? "∞" : shown(high, unit)}`);
  const length = (body) => (body.length === null ? "point mass" : shown(body.length, "m", 6));
  const ends = (joint) => `${joint.parent.body} – ${joint.child.body}`;
  const name = ["name", (row) => row.name];
  const parameters = [name, ["value", (row) => shown(row.value, row.unit, 7), (row) => row.value], ["range", range]];
  const plain = [name, ["value", (row) => row.value], ["unit", (row) => row.unit]];
  return [
    contents.parameters.length > 0 && sortedTable("Parameters", parameters, () => contents.parameters, { plain }).body,
    sortedTable("Bodies", [name, ["length", length, (row) => row.length ?? -1], ["mass", (row) => shown(row.mass, "kg", 6), (row) => row.mass]], () => contents.bodies).body,
    sortedTable("Joints", [name, ["kind", (row) => row.kind], ["between", ends], ["driven", (row) => (row.driven.length ? "driven" : "")]], () => contents.joints).body,
    certificateText(), ...openText(), provenanceText(),
  ];
}

/** Whether the certificate is about forces too: it is where enough was wanted. */
const forcesChecked = contents.certificate.residuals.some((one) => one.name === "balance");

function certificateText() {
  const { state, residuals, tolerance, words } = contents.certificate;
  const right = forcesChecked ? "Checked independently, and right" : "The motion is checked, and right; the forces are not checked, because outputs are missing";
  const head = { certified: right, failed: "The check fails: do not trust these numbers", none: "Not checked" }[state];
  const described = (one) => (one.largest === null ? "–" : format(one.largest, 2));
  const lines = residuals.filter((one) => one.name !== "condition").map((one) => [one.what, described(one)]);
  const limit = lines.length > 0 && element("p", {}, `No residual may be above ${format(tolerance, 2)}.`);
  const loops = residuals.filter((one) => one.name === "condition").map((one) => element("p", {}, `The condition number of the loops is at most ${described(one)}; 1 is best, and it grows without bound towards a dead centre.`));
  const alarm = state === "failed" && element("p", { class: "alarm" }, words);
  const forces = "The reported motions, reactions, efforts and loads were inserted into the Newton-Euler equations of every body, by an independent program, at every instant.";
  const sentence = forcesChecked ? forces : "The positions of all bodies were recomputed from the reported motion, by an independent program, at every instant.";
  const other = element("p", { class: "alarm other" }, "This is the certificate of the file's design. Designs chosen by the sliders are evaluated by the same code and refused if they are impossible, but they are not certified: evaluate them from the command line for that.");
  showing(() => (other.hidden = designState() === "file"));
  return textSection("Certificate", other, element("p", { class: `verdict ${state}` }, head), alarm, state !== "none" && element("p", {}, sentence), listOf(lines), limit, ...loops);
}

function openText() {
  const { undetermined, notes } = contents;
  return [
    undetermined.length > 0 && textSection("Undetermined",
      element("p", {}, "Equilibrium does not determine these: the mechanism is over-constrained."),
      element("ul", {}, undetermined.map((name) => element("li", {}, element("code", {}, name))))),
    notes.length > 0 && textSection("Notes", element("ul", {}, notes.map((note) => element("li", {}, note)))),
  ];
}

function provenanceText() {
  const { backend, precision, compiler, flags, versions } = contents.provenance;
  const { total, count } = instants;
  const lines = [
    ["instants", count < total ? `${total}, of which pictures and charts show ${count}; the tables are of all` : String(total)],
    ["method", [backend, precision, compiler, flags].filter(Boolean).join(", ")],
    ...Object.entries(versions),
  ];
  return textSection("How the numbers were made", listOf(lines, { class: "wide" }), element("p", { class: "fine" }, `${contents.conventions}.`));
}
