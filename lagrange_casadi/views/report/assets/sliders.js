// The parameters of a live page: a slider each; what one changes is evaluated at once, and all that is shown goes with it.

const STRETCH = 2; // Where a range has no end, a slider goes to so many times the value of the file, or to the file's value over it.

/** Functions of C's library that Math lacks; none of them rounds. */
const C = {
  fmod: (x, y) => x % y,
  remainder: (x, y) => {
    const size = Math.abs(y);
    let part = Math.abs(x % (2 * y));
    const above = 2 * part > size;
    if (above) part -= size;
    if (above && 2 * part >= size) part -= size;
    return x < 0 || Object.is(x, -0) ? -part : part;
  },
  fmin: (x, y) => (x < y || Number.isNaN(y) ? x : y),
  fmax: (x, y) => (x > y || Number.isNaN(y) ? x : y),
};

/** Start the engine of a live page, and put its sliders under the picture; says so where a browser has none. */
async function comeAlive(panel, stage) {
  try {
    const { instance } = await WebAssembly.instantiate(bytesOf(contents.live.module), { Math, C });
    live.engine = new Alive(instance);
    live.drag = new Drag(live.engine, stage);
    panel.append(...slidersOf(live.engine));
    if (window.parent !== window) listenToPage();
  } catch (error) {
    panel.append(element("p", { class: "alarm" }, `This browser cannot run the engine of this page (${error.message}); the design of the file is shown.`));
    if (!(error instanceof WebAssembly.CompileError)) throw error;
  }
}

const live = { engine: null, drag: null, alarm: null, asked: null, moving: false, late: 0, fields: [], turn: 0 };

const LATE = 150; // After so many milliseconds without a change, what is slow follows: tables, fine maps, what is out of sight.

const BUDGET = 7; // So many milliseconds of a picture of the screen are for this script while a slider moves; the rest is the browser's.

/** What the page is about now: the file's own design, another one, or one that has no result. */
function designState() {
  if (!live.engine || live.engine.own) return "file";
  return live.engine.why ? "none" : "other";
}

/** The ends of a parameter's slider: its declared range, as far as that has ends. */
function rangeOf({ value, low, high }) {
  const size = Math.abs(value) || 1;
  const [from, to] = value > 0 ? [value / STRETCH, value * STRETCH] : [value - STRETCH * size, value + STRETCH * size];
  // A length or mass of nothing is no end that a slider should reach.
  const least = low === null ? from : low === 0 && value > 0 ? from : low;
  return [least, high ?? Math.max(to, least + size)];
}

function slidersOf(engine) {
  const rows = contents.parameters.map((one, k) => {
    const [low, high] = rangeOf(one);
    const set = (value, from) => {
      for (const other of [slider, field]) if (other !== from) other.value = value;
      live.drag.before = null;
      ask(engine.values.map((before, n) => (n === k ? value : (live.asked ?? engine.values)[n])));
    };
    const words = { "aria-label": `${one.name}${one.unit === "1" ? "" : `, ${one.unit}`}` };
    const slider = element("input", { type: "range", min: low, max: high, step: "any", value: one.value, ...words, input: () => set(shortest(Number(slider.value), high - low), slider), change: settle });
    const field = element("input", { type: "number", step: "any", min: one.low, max: one.high, value: one.value, ...words, input: () => {
      if (field.value !== "" && Number.isFinite(Number(field.value))) set(Number(field.value), field);
    }, change: settle });
    const reads = element("output", {});
    const describe = () => (reads.textContent = ["m", "rad", "1"].includes(one.unit) && !scaleFor(one.unit, Math.abs(engine.values[k])).unit ? "" : shown(engine.values[k], one.unit, 5));
    live.fields.push([slider, field]);
    showing(describe);
    const freed = `${one.name} follows whatever joint is dragged`;
    const free = element("input", { type: "checkbox", title: freed, "aria-label": freed, change: () => (live.drag.freed[k] = free.checked) });
    return element("label", {}, element("span", { class: "name" }, one.name), slider, field, reads, free);
  });
  const own = signButton("↺", "The design of the file", () => setAll(engine.file.values));
  const copy = copyButton("copy as --set", () => commandOf(engine), "command line");
  const python = copyButton("copy as Python", () => linesOf(engine), "Python");
  live.alarm = element("p", { class: "alarm", role: "alert", hidden: true });
  return [element("header", {}, element("h3", {}, "Parameters"), own, copy, python), element("div", { class: "sliders" }, rows), live.alarm];
}

/** A value of a slider with no more digits than it can be set to. */
function shortest(value, wide) {
  const digits = Math.max(0, Math.min(15, 3 - Math.floor(Math.log10(wide || 1))));
  return Number(value.toFixed(digits));
}

/** Show the designs that the page around this one sends, by values of parameters, and send it that this one is ready. */
function listenToPage() {
  window.addEventListener("message", (event) => {
    if (event.source !== window.parent || typeof event.data?.design !== "object") return;
    setAll(contents.parameters.map((one, k) => Number(event.data.design[one.name] ?? live.engine.file.values[k])));
  });
  window.parent.postMessage("alive", "*");
  // The page around this one has room for all that is largest in links.
  const watcher = new ResizeObserver(() => {
    const links = document.querySelector(".links") ?? document.querySelector(".left");
    window.parent.postMessage({ height: Math.ceil(links.getBoundingClientRect().bottom + window.scrollY) + 12 }, "*");
  });
  for (const part of [document.querySelector(".left"), document.querySelector(".links")]) if (part) watcher.observe(part);
}

/** The command line that evaluates the design. */
function commandOf(engine) {
  const quoted = (word) => (/^[\w@%+=:,./-]+$/.test(word) ? word : `'${word.replaceAll("'", `'"'"'`)}'`);
  return [contents.live.command, ...changedIn(engine).map((one) => `--set ${quoted(`${one.name}=${one.value}`)}`)].join(" ");
}

/** The declarations of the parameters that are not as the case declares them. */
function linesOf(engine) {
  const end = (name, value) => (value === null ? "" : `, ${name}=${value}`);
  const line = (one) => `m.parameter("${one.name}", ${one.value}, "${one.unit}"${end("low", one.low)}${end("high", one.high)})`;
  return changedIn(engine).map(line).join("\n") || "# All parameters are as the case declares them.";
}

function changedIn(engine) {
  return contents.parameters.filter((_, k) => engine.values[k] !== engine.file.defaults[k]);
}

function fillFields(values) {
  values.forEach((value, k) => live.fields[k].forEach((field) => (field.value = value)));
}

/** Have a design shown, and its values in all fields. */
function setAll(values) {
  fillFields(values);
  live.drag.before = null;
  ask(values);
  settle();
}

/** Have a design shown, once for each picture of the screen. */
function ask(values) {
  if (!live.asked) requestAnimationFrame(answer);
  live.asked = Float64Array.from(values);
}

function answer() {
  const end = performance.now() + BUDGET;
  const values = live.asked;
  live.asked = null;
  live.moving = true;
  document.documentElement.classList.add("moving");
  if (live.drag.pointer) live.drag.show(chartsPlaces());
  else live.engine.show(values, chartsPlaces());
  renewAll();
  follow(end);
  clearTimeout(live.late);
  live.late = setTimeout(arrive, LATE);
}

/** Whether a chart shows what is largest along a link at each instant, which is more than peaks need. */
function chartsPlaces() {
  return deck.cards.some(({ plot }) => plot instanceof Chart && [plot.x, ...plot.curves].some((curve) => curve.places));
}

/** While a slider moves: have cards in sight show the design, one after another, as many as there is time for; the others have their turn
 *  at the next picture of the screen. */
function follow(end) {
  const cards = deck.cards.filter((card) => card.stale && card.seen);
  for (let k = 0; k < cards.length && (k === 0 || performance.now() < end); k += 1) {
    const card = cards.find((one) => deck.cards.indexOf(one) >= live.turn && one.stale) ?? cards.find((one) => one.stale);
    live.turn = deck.cards.indexOf(card) + 1;
    card.renew();
  }
}

/** When a slider rests: everything, in full. */
function arrive() {
  live.moving = false;
  document.documentElement.classList.remove("moving");
  live.engine.show(live.engine.values);
  renewAll();
  for (const fill of reading.tables) fill();
}

/** Have all that is shown show what the arrays hold now. */
function renewAll() {
  const { why } = live.engine;
  remembered = new WeakMap();
  deck.stage.trace();
  player.renew();
  const gaps = (why && live.engine.stand(player.instant)) || [];
  live.alarm.hidden = !why;
  live.alarm.textContent = why ? `There is no such design: ${[outOfRange().join("; ") || why, ...gaps.map(({ words }) => words)].join("; ")}.` : "";
  for (const watcher of reading.watchers) watcher();
}

/** The parameters of the design that are out of their declared ranges, with these. */
function outOfRange() {
  const { values } = live.engine;
  return contents.parameters.flatMap(({ name, unit, low, high }, k) => {
    if ((low === null || values[k] >= low) && (high === null || values[k] <= high)) return [];
    const [from, to] = [low, high].map((end) => (end === null ? "" : shown(end, unit)));
    const range = !to ? `at least ${from}` : !from ? `at most ${to}` : `from ${from} to ${to}`;
    return [`${name} = ${shown(values[k], unit)} is out of range; it must be ${range}`];
  });
}

/** When a slider is let go: scales and the sheet fit what is shown now. */
function settle() {
  requestAnimationFrame(() => {
    if (live.engine.why) return;
    measureAll();
    deck.stage.renew();
  });
}
