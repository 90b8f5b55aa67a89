// What the heads of all pages have: a name, words, and switches; and the drawing anew that these and another width ask for.

function switchButton(words, title, press) {
  return element("button", { type: "button", class: "switch", title, click: press }, words);
}

/** The switch of units; `then` hears of it. */
function siSwitch(then = () => {}) {
  const si = switchButton("SI units", "Units of the file: SI, without prefixes", () => {
    setSi(!reading.si);
    then();
  });
  showing(() => (si.ariaPressed = String(reading.si)));
  return si;
}

function printSwitch(print = () => window.print()) {
  return switchButton("Print", null, print);
}

function headWith(title, described, aside, ...switches) {
  return element("header", { class: "head" }, element("div", {}, element("h1", {}, title), described), aside, element("div", { class: "switches" }, switches));
}

/** Draw anew with the width of an element, and in light or dark. */
function drawWith(body, draw) {
  let width = 0;
  new ResizeObserver(() => {
    if (body.clientWidth === width || !body.isConnected) return;
    width = body.clientWidth;
    draw();
  }).observe(body);
  window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw, { signal: ended.signal });
}
