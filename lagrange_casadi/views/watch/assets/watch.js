// The page of a case that is followed: what is done with what was saved, what is wrong with it, its drawing, and the viewer.

const now = { state: { save: 0 }, drawing: null, contents: null, shown: 0, waiting: 0, viewer: null, since: 0 }; // `shown` is the save that the viewer shows.

const BRIEF = 700; // Milliseconds that what is slower may take for what is faster to be passed over: a page that stands is built once.

const report = document.getElementById("report");
const doing = element("p", { role: "status" });
const wrong = element("pre", { role: "alert", hidden: true });
const notes = element("ul", { hidden: true });
const bar = element("div", { class: "watching" }, doing, wrong, notes);
const picture = element("div", { class: "now" });
const title = document.title;
report.before(bar);

/** Write what is done, and what is wrong. */
function describe() {
  const { state, shown } = now;
  const seconds = Math.round((performance.now() - now.since) / 1000);
  const old = shown === state.save || !shown ? "" : "; charts and tables are of an earlier save";
  say(doing, state.doing ? `${state.doing}${seconds > 1 ? `, ${seconds} s` : ""}${old}` : state.error ? `error${old}` : "up to date");
  bar.classList.toggle("busy", Boolean(state.doing));
  bar.classList.toggle("wrong", Boolean(state.error));
  say(wrong, state.error ? `error: ${state.error}` : "");
  wrong.hidden = !state.error;
  notes.replaceChildren(...(state.notes ?? []).map((note) => element("li", {}, `note: ${note}`)));
  notes.hidden = !state.notes?.length;
  document.title = state.error ? `✗ ${title}` : title;
  report.classList.toggle("stale", shown > 0 && shown !== state.save);
  if (state.error) place();
}

/** Have the drawing in the place of the mechanism in motion, as long as that is of an older save. */
function place() {
  if (!now.drawing || now.drawing.save <= now.shown) picture.remove();
  else (report.querySelector(".frame") ?? report).append(picture);
}

/** Build the viewer anew, as its reader has it. */
function build() {
  clearTimeout(now.waiting);
  const [before, scroll] = [now.viewer?.state(), window.scrollY];
  const focus = [".picture", ".find", ".transport input"].find((what) => document.activeElement?.matches(what));
  now.viewer?.end();
  report.replaceChildren();
  document.getElementById("contents").textContent = JSON.stringify(now.contents.contents);
  now.viewer = viewer(before);
  now.shown = now.contents.save;
  report.dataset.save = now.shown;
  place();
  window.scrollTo(0, scroll);
  if (focus) report.querySelector(focus).focus({ preventScroll: true });
  describe();
}

const hear = {
  state: (state) => {
    if (state.save !== now.state.save) now.since = performance.now();
    now.state = state;
    describe();
  },
  drawing: (drawing) => {
    now.drawing = drawing;
    const { documentElement } = new DOMParser().parseFromString(drawing.svg, "image/svg+xml");
    picture.replaceChildren(document.importNode(documentElement, true));
    if (now.shown) setTimeout(place, BRIEF / 2);
    else place();
  },
  contents: (contents) => {
    now.contents = contents;
    clearTimeout(now.waiting);
    if (contents.whole) build();
    else now.waiting = setTimeout(build, BRIEF);
  },
};

const news = new EventSource("news");
for (const [name, act] of Object.entries(hear)) news.addEventListener(name, ({ data }) => act(JSON.parse(data)));
news.addEventListener("error", () => say(doing, "the program that follows the case has ended, or is out of reach"));
setInterval(() => now.state.doing && describe(), 1000);
