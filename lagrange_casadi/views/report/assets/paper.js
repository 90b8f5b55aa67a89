// The sheet that the mechanism is drawn on: from where it is looked at, its colours, and what hides what.
//
// Everything is drawn with the browser's 2D canvas, orthographically, what is far first. A mechanism is some hundred shapes, which
// that does at the rate of the screen; and it opens on every machine, also where there is no graphics card or a remote desktop,
// and prints as sharp as the text around it.

const ORDER = { floor: 0, traces: 1, rails: 2, ribbons: 3, solids: 4, joints: 5, arrows: 6, names: 7 };

class Paper {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext("2d");
    this.camera = { centre: extent.middle, scale: 1, shift: [0, 0] };
    this.turnTo(-60, 25);
  }

  /** Read the colours that the page has now. */
  readInks() {
    const style = getComputedStyle(this.canvas);
    // As a colour of an element what is light or dark is one of both.
    const ink = (name) => {
      this.canvas.style.color = `var(--${name})`;
      return style.color;
    };
    const names = ["ink", "soft", "faint", "sheet", "metal", "reaction", "effort", "load", "positive", "negative", "path", "accent", "bad", "map-positive", "map-negative", "map-none"];
    this.inks = Object.fromEntries(names.map((name) => [name, ink(name)]));
    this.inks.bodies = Array.from({ length: BODY_COLOURS }, (_, k) => ink(`body-${k}`));
  }

  /** Fit the canvas's own points to those of the screen, or to a size that is given. */
  resize(width = this.canvas.clientWidth || 640, height = this.canvas.clientHeight || 420, ratio = window.devicePixelRatio || 1) {
    [this.width, this.height] = [width, height];
    this.ratio = Math.min(ratio, 3);
    this.hatch = null;
    this.canvas.width = Math.round(this.width * this.ratio);
    this.canvas.height = Math.round(this.height * this.ratio);
  }

  /** Look from an azimuth about the upward axis, and an elevation above the level [deg]; a plane is looked at from before it. */
  turnTo(azimuth, elevation) {
    const camera = this.camera;
    [camera.azimuth, camera.elevation] = [azimuth, Math.max(-90, Math.min(90, elevation))];
    if (!contents.space) {
      [camera.right, camera.up, camera.toward] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
      return;
    }
    const exact = (value) => (Math.abs(value - Math.round(value)) < 1e-12 ? Math.round(value) : value);
    const [a, e] = [camera.azimuth, camera.elevation].map((angle) => (angle * Math.PI) / 180);
    const [c, s, ce, se] = [Math.cos(a), Math.sin(a), Math.cos(e), Math.sin(e)].map(exact);
    const [right, away, up] = contents.upright;
    const on = (x, y, z) => [0, 1, 2].map((k) => x * right[k] + y * away[k] + z * up[k]);
    camera.right = on(-s, c, 0);
    camera.up = on(-se * c, -se * s, ce);
    camera.toward = on(ce * c, ce * s, se);
  }

  /** Have the whole mechanism, over all instants, on the sheet, and other places, with room for at least a `reach` [m]; find how far they reach. */
  fit(others = [], reach = [0, 0]) {
    const camera = this.camera;
    camera.centre = extent.middle;
    const at = [...allPlaces, ...others].map((place) => less(place, camera.centre));
    const ends = [camera.right, camera.up].map((axis) => endsOf(at.map((from) => dot(from, axis))));
    const [x, y] = ends.map(([low, high]) => Math.max(high - low, 0.25 * extent.size));
    const [wide, high] = [this.width, this.height].map((side) => side - 2 * Math.min(56, 0.12 * side));
    camera.scale = Math.min(wide / Math.max(x, reach[0]), high / Math.max(y, reach[1]));
    const middle = ends.map(([low, high]) => (low + high) / 2);
    camera.shift = [-camera.scale * middle[0], camera.scale * middle[1]];
    return [x, y];
  }

  /** Where a place is on the sheet: across, down, and how near it is. */
  on(place) {
    const { centre, right, up, toward, scale, shift } = this.camera;
    const from = less(place, centre);
    return [this.width / 2 + shift[0] + scale * dot(from, right), this.height / 2 + shift[1] - scale * dot(from, up), dot(from, toward)];
  }

  /** A direction on the sheet, for each metre. */
  along(direction) {
    const { right, up, scale } = this.camera;
    return [scale * dot(direction, right), -scale * dot(direction, up)];
  }

  begin() {
    this.items = [];
    const context = this.context;
    context.setTransform(this.ratio, 0, 0, this.ratio, 0, 0);
    context.clearRect(0, 0, this.width, this.height);
    context.lineJoin = "round";
    context.lineCap = "round";
  }

  /** Have something painted: what has a higher order hides all of a lower one, and of the same order the nearer the farther. */
  put(order, depth, paint) {
    this.items.push({ order, depth, paint, number: this.items.length });
  }

  end() {
    this.items.sort((a, b) => a.order - b.order || a.depth - b.depth || a.number - b.number);
    for (const item of this.items) {
      this.context.save();
      item.paint(this.context);
      this.context.restore();
    }
  }

  /** A pattern of slanted lines, by which negative values are recognised without colours. */
  hatched(colour) {
    if (!this.hatch) {
      const tile = document.createElement("canvas");
      const size = 7;
      tile.width = tile.height = Math.round(size * this.ratio);
      const context = tile.getContext("2d");
      context.scale(tile.width / size, tile.width / size);
      for (const from of [-size, 0, size]) {
        lineThrough(context, [[from - 1, size + 1], [from + size + 1, -1]]);
        strokeWith(context, colour, 1.1);
      }
      this.hatch = this.context.createPattern(tile, "repeat");
      this.hatch.setTransform(new DOMMatrix().scale(1 / this.ratio));
    }
    return this.hatch;
  }
}

/** Red, green and blue of a colour like rgb(31, 95, 191), from 0 to 255. */
const partsOfInk = (colour) => colour.match(/\d+/g).map(Number);

const shades = {};

/** A colour with light (above 0) or dark (below 0) mixed in. */
function shade(colour, part) {
  const to = part > 0 ? 255 : 0;
  const mixed = () => partsOfInk(colour).map((value) => Math.round(value + Math.abs(part) * (to - value)));
  return (shades[`${colour} ${part}`] ??= `rgb(${mixed().join(" ")})`);
}

/** The same colour, through which one sees. */
const sheer = (colour, part) => `color-mix(in srgb, ${colour} ${100 * part}%, transparent)`;

function lineThrough(context, points, closed = false) {
  context.beginPath();
  points.forEach(([x, y], k) => (k ? context.lineTo(x, y) : context.moveTo(x, y)));
  if (closed) context.closePath();
}

/** Add a line to the path that stands. */
function addLine(context, from, to) {
  context.moveTo(from[0], from[1]);
  context.lineTo(to[0], to[1]);
}

function circleAround(context, x, y, r) {
  context.beginPath();
  context.arc(x, y, r, 0, 2 * Math.PI);
}

function fillWith(context, ink) {
  context.fillStyle = ink;
  context.fill();
}

function strokeWith(context, ink, width) {
  context.strokeStyle = ink;
  context.lineWidth = width;
  context.stroke();
}

/** Words on what is drawn already: an edge parts them from that. */
function writeOn(context, words, x, y, ink, edge, width) {
  context.strokeStyle = edge;
  context.lineWidth = width;
  context.strokeText(words, x, y);
  context.fillStyle = ink;
  context.fillText(words, x, y);
}

/** From a point of the sheet to another: how far, and the direction. */
function wayTo(a, b) {
  const [x, y] = [b[0] - a[0], b[1] - a[1]];
  const length = Math.hypot(x, y);
  return length ? [length, x / length, y / length] : [0, 1, 0];
}
