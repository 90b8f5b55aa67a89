// What the reader of a viewer has chosen: it is kept over new contents, and what these lack until others have it again.

/** What can be chosen now of what was chosen on a card of each kind; nothing where its parts are not there. */
const THERE = {
  chart: ({ x, names }) => {
    const known = names.filter((name) => seriesByName.has(name));
    return known.length && { x: x === "t" || (x === "over" && over) || seriesByName.has(x) ? x : alongInstants, names: known };
  },
  section: ({ link, ratio }) => sectionByLink.has(link) && { link, ratio: Math.min(ratio, sectionByLink.get(link).xi.length - 1) },
  map: ({ link, name }) => sectionByLink.has(link) && mappedOf(link).some((one) => one.name === name) && { link, name },
  diagram: ({ link, when }) => diagramLinks().some((one) => one.link === link) && { link, when },
  polar: ({ joint, way }) => {
    const one = polarJoints().find(({ name }) => name === joint);
    return one && { joint, way: polarWays(one)[way] ? way : "0" };
  },
};

const keptOf = ({ kind, state }) => structuredClone({ kind, state });

/** Make the cards that were chosen; returns these, and what was chosen in the place of those that cannot be made now. */
function takeCards(cards) {
  for (const card of [...deck.cards]) card.remove();
  return cards.map((wish) => {
    const chosen = THERE[wish.kind](wish.state);
    const card = chosen && addCard(wish.kind, chosen);
    return card ? Object.assign(card, { wish, made: JSON.stringify(keptOf(card)) }) : wish;
  });
}

/** What is chosen now: cards that were not touched as they were wished, then those that were added. */
function cardsNow(taken) {
  const there = [...new Set([...taken, ...deck.cards])].filter((one) => !one.body || deck.cards.includes(one));
  return there.map((one) => (!one.body || JSON.stringify(keptOf(one)) === one.made ? (one.wish ?? one) : keptOf(one)));
}

/** Have a page as it was before, as far as its contents allow; returns what gives how it is, and what ends it. */
function keep(before) {
  const { stage } = deck;
  const { camera } = stage.paper;
  const speed = document.querySelector(".transport select");
  const search = document.querySelector(".find");
  const si = document.querySelector(".switch");
  let taken = [];
  if (before) {
    if (before.cards) taken = takeCards(before.cards);
    for (const [what, value] of Object.entries(before.shows)) stage.choose(what, value);
    stage.trace();
    stage.touched = before.touched && before.space === contents.space;
    if (stage.touched) Object.assign(camera, before.camera);
    stage.paper.turnTo(before.camera.azimuth, before.camera.elevation);
    stage.renew();
    const { pinned } = before;
    if (pinned && sectionByLink.has(pinned.link)) stage.pinned = pinned;
    player.seconds = Number((speed.value = before.seconds));
    if (before.si) si.click();
    search.value = before.search;
    if (before.search) search.dispatchEvent(new Event("input"));
    player.pause();
    player.seek(instantAt(before.time), before.time);
    if (before.playing) player.play();
  }
  const first = before?.cards ? null : JSON.stringify(deck.cards.map(keptOf));
  const still = instants.count < 2;
  return {
    state: () => {
      const cards = cardsNow(taken);
      return {
        cards: JSON.stringify(cards) === first ? null : cards,
        shows: ribbonForces.length ? stage.shows : { ...stage.shows, ribbon: before?.shows.ribbon },
        camera: { ...camera }, touched: stage.touched, space: contents.space,
        pinned: stage.pinned, seconds: speed.value, si: reading.si, search: search.value,
        time: player.time,
        playing: still ? before?.playing ?? true : player.playing,
      };
    },
    end: () => {
      player.pause();
      ended.abort();
    },
  };
}

return keep(before);
