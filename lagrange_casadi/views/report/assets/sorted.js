// Tables that can be sorted, and copied as CSV.

/** A table: heads as [words, how a cell is written, what it is sorted by]; `chosen` hears of a row that is pressed, and `described` says what that does; of more rows than `most` the first are shown.
 *
 * `plain` are heads for the copy, whose numbers are those of the file: SI, with all their digits. */
function sortedTable(caption, heads, rows, { chosen = null, described = "Show this instant", aside = null, plain = heads, most = Infinity, kind = "" } = {}) {
  let order = { column: -1, down: false };
  const body = element("tbody");
  const more = element("p", { class: "fine" });
  const cells = heads.map(([words, , by], k) =>
    element("th", { scope: "col", class: by ? "number" : "" }, element("button", { type: "button", click: () => sort(k) }, words)),
  );
  const fill = () => {
    const found = ordered();
    body.replaceChildren(
      ...found.slice(0, most).map((row) => {
        const line = element("tr", {}, heads.map(([, describe, by], k) => element(k ? "td" : "th", { class: by ? "number" : "", scope: k ? null : "row" }, describe(row))));
        if (chosen) {
          line.classList.add("pressable");
          line.addEventListener("click", () => chosen(row));
          line.firstChild.prepend(element("button", { type: "button", class: "go", title: described, "aria-label": `${described}: ${row.name}` }, "▸"));
        }
        return line;
      }),
    );
    const left = found.length - most;
    more.textContent = left > 0 ? `and ${left} more, which the copy has` : "";
  };
  const ordered = () => {
    if (order.column < 0) return rows();
    const [, describe, by] = heads[order.column];
    const key = by ?? describe;
    const found = rows().toSorted((a, b) => {
      const [x, y] = [key(a), key(b)];
      return typeof x === "string" ? x.localeCompare(y) : (x ?? -Infinity) - (y ?? -Infinity);
    });
    return order.down ? found.reverse() : found;
  };
  const sort = (column) => {
    const numeric = Boolean(heads[column][2]);
    order = { column, down: order.column === column ? !order.down : numeric };
    cells.forEach((cell, k) => (cell.ariaSort = k !== column ? null : order.down ? "descending" : "ascending"));
    fill();
  };
  const copy = copyButton("copy as CSV", () => csvOf(plain, ordered()), caption);
  const table = element("table", { "aria-label": caption }, element("thead", {}, element("tr", {}, cells)), body);
  reading.tables.add(fill);
  fill();
  return { fill, body: element("section", { class: `table ${kind}` }, element("header", {}, element("h2", {}, caption), aside, copy), element("div", { class: "scroll" }, table), more) };
}

/** Rows as text for a spreadsheet, with a plain minus sign. */
function csvOf(heads, rows) {
  const quoted = (text) => {
    const cell = String(text ?? "").replaceAll("\u2212", "-").replaceAll("\u00a0", " ");
    return /[",\n;]/.test(cell) ? `"${cell.replaceAll('"', '""')}"` : cell;
  };
  const lines = [heads.map(([words]) => quoted(words)), ...rows.map((row) => heads.map(([, describe]) => quoted(describe(row))))];
  return `${lines.map((line) => line.join(",")).join("\n")}\n`;
}
