// The instant that is shown, and its going on in time.

class Player {
  constructor() {
    this.instant = 0;
    this.playing = false;
    this.seconds = 4; // that a whole cycle takes on the screen
    this.watchers = new Set();
    this.before = null;
    this.renew();
  }

  /** Show an instant by its number, at a time of the clock, and notify all who watch. */
  seek(instant, time) {
    this.instant = Math.max(0, Math.min(instants.count - 1, instant));
    this.time = time ?? instants.t[this.instant];
    for (const watcher of this.watchers) watcher(this.instant);
  }

  /** Take the times that there are now. */
  renew() {
    this.time = instants.t[this.instant];
    const [first, last] = clock?.ends ?? [instants.t[0], instants.t[instants.count - 1]];
    this.first = first;
    this.span = last - first;
  }

  step(count) {
    this.pause();
    this.seek((this.instant + count + instants.count) % instants.count);
  }

  play() {
    if (this.playing || !(this.span > 0)) return;
    this.playing = true;
    this.before = null;
    requestAnimationFrame((now) => this.tick(now));
    for (const watcher of this.watchers) watcher(this.instant);
  }

  pause() {
    if (!this.playing) return;
    this.playing = false;
    for (const watcher of this.watchers) watcher(this.instant);
  }

  tick(now) {
    if (!this.playing) return;
    if (this.before !== null) {
      const way = this.time - this.first + ((now - this.before) / 1000 / this.seconds) * this.span;
      const time = this.first + (way % this.span);
      const instant = instantAt(time);
      // Beside a longer run a shorter one stays at its end, and its clock goes on.
      if (instant !== this.instant || clock) this.seek(instant, time);
      this.time = time;
    }
    this.before = now;
    requestAnimationFrame((next) => this.tick(next));
  }
}

const player = new Player();

const toggle = () => (player.playing ? player.pause() : player.play());

/** The bar under the picture: play, pause, steps, the instant, the speed. */
function transportBar() {
  const play = signButton(icon("play"), "Play", toggle, { class: "sign play" });
  const slider = element("input", {
    type: "range", min: 0, max: instants.count - 1, step: 1, value: 0, "aria-label": "Instant",
    input: () => seekTo(Number(slider.value)),
  });
  const readout = element("output", { class: "readout" });
  const speeds = [1, 2, 4, 8, 16, 60];
  const ratio = (seconds) => {
    const times = player.span / seconds;
    return times >= 1 ? `${format(times, 2)} : 1` : `1 : ${format(1 / times, 2)}`;
  };
  const speed = chooser(
    "Speed, against real time", speeds.map((seconds) => [String(seconds), `${seconds} s a cycle, ${ratio(seconds)}`]), "4", (value) => {
      player.seconds = Number(value);
    },
  );
  const describe = (instant) => {
    const words = player.playing ? "Pause" : "Play";
    if (play.ariaLabel !== words) play.replaceChildren(icon(words.toLowerCase()));
    play.ariaLabel = words;
    play.title = `${words} (space)`;
    slider.value = instant;
    const when = whenIs(instant);
    slider.setAttribute("aria-valuetext", when);
    say(readout, when);
  };
  player.watchers.add(describe);
  showing(() => describe(player.instant));
  return element(
    "div", { class: "transport", role: "group", "aria-label": "Motion" },
    signButton(icon("back"), "One instant back (left arrow)", () => player.step(-1)),
    play,
    signButton(icon("on"), "One instant on (right arrow)", () => player.step(1)),
    slider, readout, speed,
  );
}

/** Keys for the whole page, where no field or list has them. */
function listenToKeys(stage) {
  document.addEventListener("keydown", (event) => {
    const of = event.target;
    if (event.ctrlKey || event.metaKey || event.altKey || of.matches?.("input, select, textarea, [contenteditable]")) return;
    if (event.key === " " && of.matches?.("button, a, summary")) return;
    const keys = {
      " ": toggle,
      ArrowLeft: () => player.step(event.shiftKey ? -10 : -1),
      ArrowRight: () => player.step(event.shiftKey ? 10 : 1),
      Home: () => player.step(-player.instant),
      End: () => player.step(instants.count - 1 - player.instant),
      "/": () => document.querySelector(".find").focus(),
      f: () => stage.fit(),
      F: () => stage.fit(),
      ...Object.fromEntries(VIEWS.map(([key, , angles]) => [key, () => stage.view(...angles)])),
    };
    if (!keys[event.key]) return;
    keys[event.key]();
    event.preventDefault();
  }, { signal: ended.signal });
}

/** Standard views: their key, words and angles [deg]. */
const VIEWS = contents.space
  ? [["1", "Slanted", [-60, 25]], ["2", "Front", [-90, 0]], ["3", "Right", [0, 0]], ["4", "Above", [-90, 90]]]
  : [];
