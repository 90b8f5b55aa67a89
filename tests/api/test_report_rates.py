"""How much of a picture's time the page's thread works: a large mechanism that plays, and a slider
that moves all the while.
"""

import alive
import pytest
from internals import Live
from internals import report_page as page
from reports import CASES

from lagrange_casadi import Mechanism, Scene, evaluate, load_case
from lagrange_casadi.motion import harmonic

pytestmark = [pytest.mark.long, alive.NEEDS_BROWSER]

chromium = alive.chromium

LINKS, INSTANTS = 30, 2000
PICTURE = 1000 / 30
"""What a picture may take at 30 a second [ms]."""

PLAY = """(async () => {
  const range = document.querySelector('.transport input');
  for (let k = 0; k < %d; k += 1) {
    range.value = (37 * k) %% Number(range.max);
    range.dispatchEvent(new Event('input'));
    await new Promise((done) => requestAnimationFrame(done));
  }
})()"""

DRAG = """(async () => {
  const field = document.querySelector('.sliders [type=range]');
  const [low, high] = [Number(field.min), Number(field.max)];
  for (let k = 0; k < %d; k += 1) {
    field.value = low + (0.5 + 0.02 * Math.sin(k / 7)) * (high - low);
    field.dispatchEvent(new Event('input'));
    await new Promise((done) => requestAnimationFrame(done));
  }
})()"""


def work(one, script, pictures=60):
    """What the thread of a page works for a picture of the screen [ms], by its own clock of
    processor time.
    """
    one.call("Performance.enable", timeDomain="threadTicks")
    one.run(script % 20)

    def task():
        return next(
            m["value"]
            for m in one.call("Performance.getMetrics")["metrics"]
            if m["name"] == "TaskDuration"
        )

    before = task()
    one.run(script % pictures)
    return 1e3 * (task() - before) / pictures


def chain():
    """So many links on one another, each driven."""
    m = Mechanism("chain")
    at, motion = m.ground, {}
    for k in range(LINKS):
        link = m.link(f"link{k}", length=0.1, mass=0.2)
        m.revolute(f"J{k}", at, link)
        motion[f"J{k}"] = harmonic(0.05, 0.1, 1.0 + 0.1 * k)
        at = link.tip
    return Scene(m, motion, t=(0, 1, INSTANTS))


def test_a_chain_of_thirty_links_and_two_thousand_instants_plays_at_thirty_pictures_a_second(
    chromium, tmp_path
):
    path = tmp_path / "chain.html"
    evaluate(chain(), wanted=["all"], certificate=False).report(path)
    chromium.open(path)
    alive.wait(chromium, "document.querySelectorAll('.card').length > 3")
    assert work(chromium, PLAY) < PICTURE
    assert chromium.complaints == []


@alive.NEEDS_ENGINE
@pytest.mark.parametrize("name", ["slider_crank", "delta"])
def test_a_slider_is_followed_at_thirty_pictures_a_second(chromium, tmp_path, name):
    scene = load_case(CASES / name).scene
    text = page(evaluate(scene), Live.of(scene, scene.timing(), scene.wanted, "run"))
    alive.opened(chromium, tmp_path / "live.html", text)
    assert work(chromium, DRAG) < PICTURE
    assert chromium.complaints == []
