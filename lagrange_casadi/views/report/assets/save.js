// Charts as files: a picture as SVG or PNG, and its numbers as CSV.

const STYLES = ["fill", "fill-opacity", "stroke", "stroke-width", "stroke-opacity", "stroke-dasharray", "stroke-linejoin", "font-family", "font-size", "font-weight", "text-anchor", "dominant-baseline", "paint-order"];

/** A copy of an element of a drawing that has its styles in itself. */
function styled(source) {
  const copy = source.cloneNode(false);
  const style = getComputedStyle(source);
  copy.removeAttribute("class");
  for (const name of STYLES) {
    const value = style.getPropertyValue(name);
    if (value) copy.setAttribute(name, value);
  }
  copy.append(...[...source.childNodes].map((child) => (child.nodeType === Node.ELEMENT_NODE ? styled(child) : child.cloneNode())));
  return copy;
}

/** A card's plot as one drawing, with its title and legend above it. */
function pictureOf(card) {
  const { sheet } = card.plot;
  const [width, high] = ["width", "height"].map((name) => Number(sheet.still.getAttribute(name)));
  const page = getComputedStyle(card.body);
  const write = (words, x, y, weight) => drawn("text", { x, y, fill: page.color, "font-family": page.fontFamily, "font-size": 12, "font-weight": weight }, words);
  const lines = [...card.legend.children].map((item, k) => {
    const [y, swatch] = [53 + 17 * k, item.querySelector("svg")];
    const line = swatch && styled(swatch.firstChild);
    line?.setAttribute("transform", `translate(8 ${y - 8})`);
    const words = swatch ? item.querySelector("span").textContent : item.textContent;
    return [line, write(words, swatch ? 40 : 8, y, 400)];
  });
  const top = 43 + 17 * lines.length;
  const parts = styled(sheet.still);
  const chosen = [...card.choices.querySelectorAll("select:not(.curves)")].map((list) => list.selectedOptions[0]?.textContent);
  const { canvas, across, up } = card.plot;
  const map = canvas && drawn("image", { x: across.from, y: up.to, width: across.to - across.from, height: up.from - up.to, href: canvas.toDataURL(), preserveAspectRatio: "none" });
  return drawn("svg", { xmlns: "http://www.w3.org/2000/svg", width, height: high + top, viewBox: `0 0 ${width} ${high + top}` },
    drawn("rect", { width, height: high + top, fill: page.backgroundColor }),
    write([contents.case, card.title.textContent].join(", "), 8, 18, 650), write(chosen.join(", "), 8, 35, 400), lines.flat(),
    drawn("g", { transform: `translate(0 ${top})` }, map, ...parts.childNodes));
}

/** Have the browser save something that an address holds. */
function saveAs(name, address) {
  element("a", { href: address, download: name }).click();
}

const textAddress = (kind, text) => `data:${kind};charset=utf-8,${encodeURIComponent(text)}`;

/** Save a card's plot as a file of a kind. */
async function saveCard(card, kind) {
  if (!card.plot) return;
  const name = `${[contents.case, card.title.textContent].join("_").replace(/[^\p{L}\p{N}]+/gu, "_")}.${kind}`;
  if (kind === "csv") {
    const { heads, rows } = card.plot.table();
    saveAs(name, textAddress("text/csv", csvOf(heads.map((head, k) => [head, (row) => (Number.isFinite(row[k]) ? row[k] : "")]), rows)));
    return;
  }
  const drawing = pictureOf(card);
  const address = textAddress("image/svg+xml", new XMLSerializer().serializeToString(drawing));
  if (kind === "svg") {
    saveAs(name, address);
    return;
  }
  const image = new Image();
  image.src = address;
  await image.decode();
  const [width, height] = ["width", "height"].map((side) => 2 * Number(drawing.getAttribute(side)));
  const canvas = element("canvas", { width, height });
  canvas.getContext("2d").drawImage(image, 0, 0, width, height);
  saveAs(name, canvas.toDataURL("image/png"));
}

/** The list by which a card's plot is saved. */
function saveList(card) {
  const list = chooser("Save this plot", [["", "save"], ["svg", "as SVG"], ["png", "as PNG"], ["csv", "as CSV"]], "", (kind) => {
    list.value = "";
    if (kind) saveCard(card, kind);
  });
  list.classList.add("save");
  return list;
}

/** A curve's head in a table: its name, and its unit in the file. */
const headOfCurve = (curve) => `${curve.name || curve.title} [${curve.unit}]`;
