"""What cannot be in space, at instants or for parameters, is refused in a line that names the
part.
"""

import math

import casadi as ca
import pytest
from mechanisms import pins_of

from lagrange_casadi import LagrangeCasadiError, Scene, SpatialMechanism, evaluate
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.usefixtures("interpreted")

LOCK = math.pi / 2


def ball(*law, **scene):
    """A link driven in its three turns, the second by a law."""
    m = SpatialMechanism("ball")
    m.spherical("A", m.ground, m.link("a", length=0.6, mass=1.0))
    laws = [polynomial(0.3, 1.0), polynomial(*law), polynomial(0.1, 0.3)]
    return Scene(m, {"A": laws}, **{"t": (0, 1, 101), **scene})


def held(law=None, links=None, **scene):
    """A rod between two spherical joints, which is rigid: the turns of the first are coordinates;
    or has a mass along it.
    """
    m = SpatialMechanism("held")
    crank, slider = m.link("crank", length=0.1, mass=1.0), m.link("slider", length=0.1, mass=1.0)
    lump = {"centre": (0.1, 0.0, 0.0), "inertia": (1.0, 1.0, 1.0)} if links is None else {}
    rod = m.link("rod", length=0.3, mass=1.0, **lump)
    m.revolute("O", m.ground, crank, axis=(0, 1, 0))
    m.spherical("A", crank.tip, rod)
    m.spherical("B", rod.tip, slider)
    m.prismatic("G", m.ground.at(0, 0.05 * bool(lump), 0), slider, axis=(1, 0, 0))
    laws = {"O": law or polynomial(0.0, 6.0), **scene.pop("laws", {})}
    return Scene(m, laws, **{"posture": {"G": 0.35}, **scene})


def turned(**scene):
    rough = {"G": 0.35, "A:turn_2": 0.0, "A:turn_3": 0.1}
    return held(laws={"A:turn_1": polynomial(0.3)}, posture=rough, t=(0, 1, 101), **scene)


def four_bar():
    m = SpatialMechanism("m")
    a, b, c = (
        m.link(name, length=x, mass=1.0) for name, x in zip("abc", (0.1, 0.3, 0.25), strict=True)
    )
    pins_of(m, O=(m.ground, a), A=(a.tip, b), B=(b.tip, c), C=(c.tip, m.ground.at(0.3, 0.0, 0.0)))
    return Scene(m, {"O": polynomial(0.0, 1.0)})


def leaning(second, lean, size=1.0):
    m = SpatialMechanism("leaning")
    lean, size = m.parameter("lean", lean, "rad"), m.parameter("size", size)
    a = m.link("a", length=0.3, mass=1.0)
    if second:
        axes = {"axis": (0, 0, 1), "second": (size * ca.cos(lean), 0, size * ca.sin(lean))}
        m.universal("J", m.ground, a, **axes)
        return Scene(m, {"J": (polynomial(0, 1), polynomial(0, 0.3))}, t=(0, 1, 5))
    axes = (1, 0, 0), (size * ca.sin(lean), size * ca.cos(lean), 0.0)
    m.revolute("J", m.ground, a, turned=axes)
    return Scene(m, {"J": polynomial(0, 1)}, t=(0, 1, 5))


REFUSED = {
    r"joint 'A' is in gimbal lock at t = 0\.5 s, .* choose axis and second so that turn_2 ": (
        lambda: ball(LOCK - 0.5, 1.0)
    ),
    r"joint 'A' passes gimbal lock after t = 0\.4949": lambda: ball(LOCK - 0.5, 1.0, t=(0, 1, 100)),
    r"joint 'A' is in gimbal lock at t = 0 s": lambda: ball(LOCK, 0.0),
    r"joint 'A' is in gimbal lock at t = 0\.01 s": lambda: ball(0.01 - LOCK, -1.0),
    r"joint 'A' passes gimbal lock after t = 0\.2 s": turned,
    "the spin of link 'rod' about the line from 'A' to 'B' is not determined: give one of their": (
        held
    ),
    "drive 'A:turn_1': the spin of two-force link 'rod' about its own axis moves nothing; drive": (
        lambda: held(polynomial(0.5, 6.0), "slender", drives=["A:turn_1"])
    ),
    "drive 'B:turn_1': the joint closes a loop, where its rotations are not evaluated": (
        lambda: turned(drives=["O", "B:turn_1"])
    ),
    r"has -2 degree.* to count by rank\) and 1 drive\(s\); also give a rough posture of C, A": (
        four_bar
    ),
    r"joint 'J': its axes must be at right angles, and are at 72\.8113 deg": (
        lambda: leaning(True, 0.3)
    ),
    r"joint 'J': turned: its axes must be at right angles, and are at 89\.9427 deg": (
        lambda: leaning(False, 1e-3)
    ),
    "joint 'J': its axes must not be of length zero": lambda: leaning(True, 0.0, 0.0),
}


@pytest.mark.parametrize("says", REFUSED)
def test_what_cannot_be_is_named(says):
    with pytest.raises(LagrangeCasadiError, match=says):
        evaluate(REFUSED[says](), wanted=["effort"])


FINE = {
    **{f"beside {start:g}": ball(start, 0.0) for start in (0.0, LOCK - 1e-3, LOCK + 1e-3, math.pi)},
    "near and back": ball(LOCK - 0.02, 0, -2.0, t=(-0.5, 0.5, 21)),
    "before": turned,
    "a long axis": lambda: leaning(True, 0.0, 7.0),
}


@pytest.mark.parametrize("name", FINE)
def test_beside_what_cannot_be_all_is_right(name):
    scene = FINE[name]() if callable(FINE[name]) else FINE[name]
    assert evaluate(scene, t=(0, 0.15, 31) if name == "before" else scene.t).certified
