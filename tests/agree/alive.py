"""Live pages: the engine's package, pages whose inner parts a test can reach, and a scene of which
every number may change.
"""

import importlib.util
import os
import re
import time
from pathlib import Path

import browser
import pytest

from lagrange_casadi import Mechanism, Scene, density
from lagrange_casadi.motion import polynomial

THERE = importlib.util.find_spec("ziglang") is not None

NEEDS_BROWSER = pytest.mark.skipif(browser.found() is None, reason="there is no Chromium here")
NEEDS_ENGINE = pytest.mark.skipif(not THERE, reason="ziglang is not installed")

# A session's own cache would have ziglang build its C library anew, in half a minute; it is no part
# of what is tested.
os.environ.setdefault("ZIG_GLOBAL_CACHE_DIR", str(Path.home() / ".cache" / "zig"))


@pytest.fixture(scope="module")
def chromium():
    """A browser whose user wants neither motion nor darkness."""
    with browser.Browser() as one:
        one.prefer(prefers_reduced_motion="reduce", prefers_color_scheme="light")
        yield one


def opened(one, path, text):
    """Open a page with its inner parts in ``window.page``, and wait until its engine runs.

    A script that is changed is no longer the one whose digest the page tells, so the page must not
    tell any.
    """
    text = re.sub(r"<meta http-equiv=[^>]*>", "", text)
    parts = "live, contents, array, sections, sectionForce, player, deck, C"
    assert text.count("buildPage();\n})();") == 1
    path.write_text(
        text.replace("buildPage();\n})();", f"buildPage();\nwindow.page = {{ {parts} }};\n}})();")
    )
    one.open(path)
    wait(one, "window.page.live.engine !== null")


def wait(one, condition):
    """Wait until something is so in a page."""
    end = time.monotonic() + 20.0
    while not one.run(condition):
        assert time.monotonic() < end, (condition, one.complaints)
        time.sleep(0.02)


def sheller(over=True):
    """A machine in the plane: a plate on a rod, a load that slides along a rocker, loads along
    links, a spring, a turned guide.
    """
    m = Mechanism("sheller")
    r = m.parameter("r", 0.1, "m", low=0.0)
    l = m.parameter("l", 0.45, "m")
    b = m.parameter("b", 0.12, "m")
    mass = m.parameter("m", 1.5, "kg")
    snow = m.parameter("snow", 40.0, "N/m")
    tilt = m.parameter("tilt", 0.1, "rad")
    turn, rpm = m.parameter("turn", 6.2, "rad"), m.parameter("rpm", 60.0, "1/min")
    crank = m.link("crank", length=r, mass=mass)
    rod = m.link("rod", length=l, mass=2.0)
    ram = m.point_mass("ram", 3.0 * mass)
    rocker = m.link("rocker", length=1.1 * l + b, density=density.polynomial(2.0, b, 1.0))
    drive = m.revolute("O", m.ground, crank)
    m.revolute("A", crank.tip, rod)
    m.revolute("B", rod.tip, ram)
    m.prismatic("guide", m.ground.at(0.0, b / 4), ram, axis=(1.0, tilt))
    m.revolute("C", m.ground.at(0.1, -2.0 * b), rocker)
    m.slot("way", rocker, crank.at(0.5 * r, 0.1 * b), axis=(1.0, 0.0))
    m.spring("coil", m.ground.at(0.2, b), rod.at(0.3 * l, b), stiffness=200.0, length=0.1)
    m.line_load("snow", rod, y=(-snow, 0.5 * snow), between=(0.2 * l, 0.7 * l))
    m.path("eye", rod.at(0.5 * l, -b))
    m.output("power", m.results.effort(drive) * m.rate(drive), unit="W")
    law = polynomial(0.3, 0.1047197551196597 * rpm, 0.5)
    asked = {"over": ("O", 0.3, 0.3 + turn, 61)} if over else {"t": (0.0, turn / 6.0, 61)}
    return Scene(m, {"O": law}, posture={"rod": 0.0, "rocker": 1.0}, **asked)
