// The instants of a report, and its quantities by name.

const instants = { count: contents.instants.shown, total: contents.instants.total, t: array(contents.instants.t) };

const { over } = contents.instants;

/** The axis along which instants are shown where nothing else is asked for. */
const alongInstants = over ? "over" : "t";

const seriesByName = new Map(contents.series.map((one) => [one.name, one]));
const rowByName = new Map(contents.rows.map((one) => [one.name, one]));

/** What a series or row is called where its kind is plain: "rod: bending moment". */
function titleOf(one) {
  return one.part && one.what ? `${one.part}: ${one.what}` : one.part || one.what;
}

/** The number of the instant that is nearest to a time. */
function instantAt(time) {
  const t = instants.t;
  let low = 0;
  let high = t.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (t[middle] <= time) low = middle;
    else high = middle;
  }
  return Math.abs(t[high] - time) < Math.abs(t[low] - time) ? high : low;
}
