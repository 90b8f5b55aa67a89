// What the reader of a viewer has chosen: it is kept over new contents, and what these lack until others have it again.

/** Cards by kind: what is kept of the state of each, and how a card is made again; nothing where its parts are not there. */
const CARDS = {
  chart: {
    kept: ({ x, names }) => ({ x, names: [...names] }),
    made: ({ x, names }) => {
      const known = names.filter((name) => seriesByName.has(name));
      return known.length && chartCard(known, x === "t" || (x === "over" && over) || seriesByName.has(x) ? x : alongInstants);
    },
  },
  section: {
    kept: ({ section, ratio }) => ({ link: section.link, ratio }),
    made: ({ link, ratio }) => sectionByLink.has(link) && sectionCard(sectionByLink.get(link), Math.min(ratio, sectionByLink.get(link).xi.length - 1)),
  },
  map: {
    kept: ({ link, name }) => ({ link, name }),
    made: ({ link, name }) => sectionByLink.has(link) && mappedOf(link).some((one) => one.name === name) && mapCard(link, name),
  },
  diagram: {
    kept: ({ link, when }) => ({ link, when }),
    made: ({ link, when }) => diagramLinks().some((one) => one.link === link) && diagramCard(link, false, when),
  },
  polar: {
    kept: ({ joint, way }) => ({ joint, way }),
    made: ({ joint, way }) => {
      const one = polarJoints().find(({ name }) => name === joint);
      return one && polarCard(one, false, polarWays(one)[way] ? way : "0");
    },
  },
};

const keptOf = (card) => ({ kind: card.kind, state: CARDS[card.kind].kept(card.state) });

/** Make the cards that were chosen; returns what to keep for later contents. */
function takeCards(cards) {
  for (const card of [...deck.cards]) card.remove();
  return cards.map((wish) => {
    const card = CARDS[wish.kind].made(wish.state);
    return { wish, card, made: card && JSON.stringify(keptOf(card)) };
  });
}

/** What is chosen now: cards that were not touched as they were wished, then those that were added. */
function cardsNow(taken) {
  const wished = taken.flatMap(({ wish, card, made }) => {
    if (!card) return [wish];
    if (!deck.cards.includes(card)) return [];
    const now = keptOf(card);
    return [JSON.stringify(now) === made ? wish : now];
  });
  return [...wished, ...deck.cards.filter((card) => !taken.some((one) => one.card === card)).map(keptOf)];
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
    for (const [what, value] of Object.entries(before.shows)) {
      if (what === "ribbon" && value !== "" && !ribbonForces.some((force) => force.name === value)) continue;
      stage.shows[what] = value;
      stage.controls[what]?.(value);
    }
    stage.trace();
    stage.paper.turnTo(before.view.azimuth, before.view.elevation);
    stage.renew();
    if (before.view.touched && before.space === contents.space) {
      stage.touched = true;
      Object.assign(camera, before.view.camera);
    }
    const { pinned } = before;
    if (pinned && sectionByLink.has(pinned.link)) stage.pinned = { section: sectionByLink.get(pinned.link), ratio: pinned.ratio };
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
      const { azimuth, elevation, centre, scale, shift } = camera;
      return {
        cards: JSON.stringify(cards) === first ? null : cards,
        shows: ribbonForces.length ? stage.shows : { ...stage.shows, ribbon: before?.shows.ribbon },
        view: { azimuth, elevation, touched: stage.touched, camera: { centre, scale, shift } },
        space: contents.space,
        pinned: stage.pinned ? { link: stage.pinned.section.link, ratio: stage.pinned.ratio } : null,
        seconds: speed.value, si: reading.si, search: search.value,
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
