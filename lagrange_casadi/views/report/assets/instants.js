// The instants of a report, and its quantities by name.

const instants = { count: contents.instants.shown, total: contents.instants.total, t: array(contents.instants.t) };

const { over } = contents.instants;

/** The axis along which instants are shown where nothing else is asked for. */
const alongInstants = over ? "over" : "t";

/** The number of the instant that is nearest to a time. */
const instantAt = (time) => nearest(instants.t, time);

/** The number of the instant that is nearest to a place on that axis. */
const instantOn = (place) => (over ? nearest(array(over.values), place) : instantAt(place));

const seriesByName = new Map(contents.series.map((one) => [one.name, one]));
const rowByName = new Map(contents.rows.map((one) => [one.name, one]));

/** A time in words, by the longest of all. */
const timeWords = (t) => shown(t, "s", 5, Math.max(...[0, -1].map((k) => Math.abs(instants.t.at(k)))));

/** When something is, in words: the time, and the drive's coordinate, if there is any, where instants are over one. */
function whenOf(t, place) {
  return `${over && typeof place === "number" ? `${over.joint} = ${shown(place, over.unit)}, ` : ""}t = ${timeWords(t)}`;
}

/** When an instant is, in words. */
const whenIs = (instant) => whenOf(instants.t[instant], over && array(over.values)[instant]);
