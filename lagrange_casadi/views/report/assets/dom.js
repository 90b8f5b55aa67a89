// Elements. Whatever a user has named is put in as text, so that no name is ever read as markup.

/** An element with attributes; functions are listeners, children are elements or texts. */
function element(tag, attributes = {}, ...children) {
  return filled(document.createElement(tag), attributes, children);
}

/** The same for an element of a drawing. */
function drawn(tag, attributes = {}, ...children) {
  return filled(document.createElementNS("http://www.w3.org/2000/svg", tag), attributes, children);
}

function filled(made, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === "function") made.addEventListener(name, value);
    else if (value === true) made.setAttribute(name, "");
    else if (value !== false && value !== null && value !== undefined) made.setAttribute(name, value);
  }
  made.append(...children.flat().filter((child) => child !== null && child !== undefined && child !== false));
  return made;
}

/** Have an element say something, which costs nothing where it does. */
function say(one, words) {
  if (one.textContent !== words) one.textContent = words;
}

/** A list of names and what they are. */
function listOf(lines, attributes = {}) {
  return element("dl", attributes, lines.flatMap(([name, value]) => [element("dt", {}, name), element("dd", {}, value)]));
}

/** A text with a head. */
function textSection(head, ...children) {
  return element("section", { class: "text" }, element("h2", {}, head), children);
}

/** A button with a sign on it and words for those who do not see it. */
function signButton(sign, words, press, attributes = {}) {
  return element("button", { type: "button", class: "sign", title: words, "aria-label": words, click: press, ...attributes }, sign);
}

const ICONS = {
  play: "M3 1.5L13 8L3 14.5Z",
  pause: "M3 2H6.5V14H3ZM9.5 2H13V14H9.5Z",
  back: "M12 2V14L5 8ZM2.5 2H4.5V14H2.5Z",
  on: "M4 2V14L11 8ZM11.5 2H13.5V14H11.5Z",
};

/** A sign that no font has to have. */
function icon(name) {
  return drawn("svg", { viewBox: "0 0 16 16", width: 13, height: 13, "aria-hidden": "true" }, drawn("path", { d: ICONS[name], fill: "currentColor" }));
}

/** A list to choose from: entries are [value, words], or [head, entries] for a group. */
function chooser(label, entries, chosen, change) {
  const list = element("select", { "aria-label": label, change: () => change(list.value) });
  offer(list, entries, chosen);
  return list;
}

/** Have a list offer entries, one of them chosen. */
function offer(list, entries, chosen) {
  const option = ([value, words]) => element("option", { value, selected: value === chosen }, words);
  const options = entries.map(([head, inner]) =>
    Array.isArray(inner) ? element("optgroup", { label: head }, inner.map(option)) : option([head, inner]),
  );
  list.replaceChildren(...options);
}

const said = element("div", { class: "unseen", role: "status", "aria-live": "polite" });

/** Announce to those who do not see the page. */
function announce(words) {
  said.textContent = words;
}

/** A button that copies a text, and says so for a while. */
function copyButton(words, textOf, copied) {
  const button = element("button", { type: "button", class: "copy", click: async () => {
    await copyText(textOf());
    button.textContent = "copied";
    announce(`${copied} copied`);
    setTimeout(() => (button.textContent = words), 1500);
  } }, words);
  return button;
}

/** Put a text on the clipboard; where a browser allows none to a page of a file, by a selection. */
async function copyText(text) {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    const field = element("textarea", { class: "unseen" });
    field.value = text;
    document.body.append(field);
    field.select();
    document.execCommand("copy");
    field.remove();
  }
}
