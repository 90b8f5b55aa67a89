"""Losses where gears mesh: efficiencies, which gear drives, what the certificate says, rest, and
worms that lock themselves.
"""

import math

import numpy as np
import pytest

from lagrange_casadi import Mechanism, Scene, SpatialMechanism, evaluate, load, save
from lagrange_casadi.elements import gears, wheel
from lagrange_casadi.errors import AssemblyError, DeclarationError, ParameterError
from lagrange_casadi.motion import harmonic, polynomial

pytestmark = pytest.mark.usefixtures("interpreted")

TAN = math.tan(math.radians(20.0))


def pair(kind, speed=None, **more):
    """Two gears of which the second is loaded, or brakes; or a gear and a rack."""
    sizes = {
        "outside": (0.03, 0.05, 0.08),
        "ring": (0.03, 0.05, 0.02),
        "in a ring": (0.05, 0.03, -0.02),
        "rack": (0.03, 1, 0),
    }
    r1, r2, apart = sizes[kind]
    m = Mechanism("pair")
    m.set_gravity(0, 0)
    load_, share = m.parameter("load", 40.0), m.parameter("efficiency", 0.97)
    first = m.link("first", length=0.03, mass=0.0, centre=(0, 0), inertia=0.0)
    second = m.link("second", length=0.3, mass=1e-9, centre=(0, 0), inertia=0.0)
    m.revolute("A", m.ground, first)
    if kind == "rack":
        m.prismatic("B", m.ground.at(0, -r1), second, axis=(1, 0))
        m.force("load", second, x=-load_)
        gears(m, "mesh", first, second, radii=r1, efficiency=share)
    else:
        m.revolute("B", m.ground.at(apart, 0), second)
        m.torque("load", second, load_ if kind == "outside" else -load_)
        gears(m, "mesh", first, second, radii=(r1, r2), efficiency=share)
    ratio = r1 if kind == "rack" else r1 / r2
    return Scene(m, {"A": speed or polynomial(0.1, 7.0)}, t=(0, 1, 5), **more), ratio


@pytest.mark.parametrize("kind", ["outside", "ring", "in a ring", "rack"])
@pytest.mark.parametrize("moment", [40.0, -40.0])
@pytest.mark.parametrize("share", [0.97, 0.88, 1.0])
def test_what_comes_out_is_a_share_of_what_goes_in(kind, moment, share):
    """Whichever gear drives; the couple is borne by no one else, so both torques and that on the
    bearings' frame are in balance.
    """
    scene, ratio = pair(kind)
    solution = evaluate(scene, parameters={"load": moment, "efficiency": share})
    assert solution.certified
    expected = moment * ratio * (1 / share if moment > 0.0 else share)
    assert solution.effort("A") == pytest.approx(np.full(5, expected), rel=1e-9)
    power = solution.effort("A") * 7.0 - moment * ratio * 7.0
    assert solution.output("mesh_loss") == pytest.approx(power, rel=1e-9, abs=1e-9)
    assert (power >= -1e-9).all()


def test_power_flows_backward_as_the_load_does():
    """Over a cycle the drive's work is the loss's: of a load that gives back what it took."""
    scene, _ = pair("outside", harmonic(0.0, 1.0, 1.0, 0.3))
    solution = evaluate(scene, t=(0, 1, 4001), parameters={"efficiency": 0.9})
    assert solution.certified
    work = solution.effort("A") * solution.motion("A").rate
    assert work[:-1].mean() == pytest.approx(solution.output("mesh_loss")[:-1].mean(), rel=1e-3)
    assert np.abs(solution.effort("A")).max() == pytest.approx(40 * 0.6 / 0.9, rel=1e-9)


def test_at_rest_it_is_open(tmp_path):
    scene, _ = pair("outside", polynomial(0.2))
    solution = evaluate(scene)
    assert solution.resting.all()
    assert np.isnan(solution.effort("A")).all()
    assert any("at rest" in note for note in solution.notes)
    save(solution, tmp_path / "rest.h5")
    assert load(tmp_path / "rest.h5").resting.all()


def test_with_bearings_that_rub():
    """Both depend on each other: teeth press the bearings, whose friction the teeth pass on."""
    m = Mechanism("rubbing")
    m.set_gravity(0, 0)
    first = wheel(m, "first", radius=0.03, mass=0.5)
    second = wheel(m, "second", radius=0.05, mass=1.0)
    joints = m.revolute("A", m.ground, first), m.revolute("B", m.ground.at(0.08, 0), second)
    for name, joint in zip("ab", joints, strict=True):
        m.friction(name, joint, mu=0.1, radius=0.01)
    gears(m, "mesh", first, second, radii=(0.03, 0.05), efficiency=0.95)
    m.torque("load", second, 20.0)
    solution = evaluate(Scene(m, {"A": polynomial(0.0, 9.0)}, t=(0, 1, 3)))
    assert solution.certified
    force = np.abs(solution.multiplier("mesh"))[0]
    rub = 0.1 * 0.01 * force * math.hypot(1.0, TAN)
    couple = 0.05 * 0.03 * force / (1.6 - 0.05)
    assert force * 0.05 - couple == pytest.approx(20.0 + rub, rel=1e-11)
    assert solution.effort("A")[0] == pytest.approx(force * 0.03 + couple + rub, rel=1e-11)


def worm(mu, driven, speed=3.0, hand="right", moment=-50.0):
    m = SpatialMechanism("worm")
    m.set_gravity(0, 0, 0)
    r1, r2, z = 0.02, 0.08, 40
    kwargs = {"mass": 0.0, "centre": (0, 0, 0)}
    screw = m.link("screw", length=0.1, inertia=(1e-12, 1e-12, 1e-12), **kwargs)
    turned = m.link(
        "turned", length=0.1, inertia=(1e-12, 1e-12, 1e-12), **(kwargs | {"mass": 1e-9})
    )
    m.revolute("worm", m.ground, screw, axis=(1, 0, 0))
    m.revolute("wheel", m.ground.at(0, r1 + r2, 0), turned, axis=(0, 0, 1))
    gears(
        m, "mesh", screw, turned, radii=(r1, r2), teeth=(4, z), hand=hand, mu=m.parameter("mu", mu)
    )
    m.torque(
        "load",
        turned if driven == "worm" else screw,
        **({"z": moment} if driven == "worm" else {"x": moment}),
    )
    return Scene(m, {driven: polynomial(0.0, speed)}, t=(0, 1, 3)), math.atan(4 * r2 / (z * r1))


@pytest.mark.sampled(3)
@pytest.mark.parametrize("mu", [0.0, 0.03, 0.1])
@pytest.mark.parametrize("hand", ["right", "left"])
def test_a_worm_drives_its_wheel(mu, hand):
    """Shigley, equation 13-46: (cos(phi) - mu tan(lead))/(cos(phi) + mu cot(lead))."""
    cosine = math.cos(math.radians(20.0))
    for speed in (3.0, -3.0):
        scene, lead = worm(mu, "worm", speed, hand)
        solution = evaluate(scene)
        assert solution.certified
        given, taken = solution.effort("worm") * speed, 50.0 * solution.motion("wheel").rate
        efficiency = (cosine - mu * math.tan(lead)) / (cosine + mu / math.tan(lead))
        if taken[0] > 0.0:
            assert taken / given == pytest.approx(np.full(3, efficiency), rel=1e-9)
        else:
            # The wheel pushes: with the sign of mu the other way, less is given back, or it must be
            # driven.
            back = (cosine - mu / math.tan(lead)) / (cosine + mu * math.tan(lead))
            assert given / taken == pytest.approx(np.full(3, back), rel=1e-9)
        assert given - taken == pytest.approx(solution.output("mesh_loss"), rel=1e-9, abs=1e-9)


def test_a_wheel_drives_its_worm_unless_that_locks_itself():
    scene, lead = worm(0.05, "wheel", moment=-0.5)
    solution = evaluate(scene)
    assert solution.certified
    with pytest.raises(AssemblyError, match="jams"):
        evaluate(scene, parameters={"mu": 1.1 * math.tan(lead) * math.cos(math.radians(20.0))})


@pytest.mark.quick
def test_numbers_that_cannot_be_are_refused_by_name():
    def refused(told, of=Mechanism, **more):
        m = of("bad")
        first = wheel(m, "first", radius=0.05, mass=1.0)
        second = wheel(m, "second", radius=0.1, mass=1.0)
        m.revolute("A", m.ground, first)
        m.revolute("B", m.ground.at(0.05, 0), second)
        with pytest.raises(DeclarationError) as error:
            gears(m, "mesh", first, second, radii=(0.05, 0.1), **more)
        assert str(error.value) == f"gears 'mesh': {told}"

    refused("expected mu= for crossed axes, efficiency= for others", mu=0.1)
    refused("efficiency must not be above 1, got 1.1", efficiency=1.1)
    refused("efficiency must be above 0, got 0", efficiency=0.0)
    refused("efficiency is too low for a gear in this ring, got 0.4", efficiency=0.4)
    scene, _ = pair("ring")
    with pytest.raises(AssemblyError, match="friction 'mesh:loss': the mechanism jams"):
        evaluate(pair("in a ring")[0], parameters={"efficiency": 0.75})
    for value in (1.2, 0.0, 0.5):
        with pytest.raises(ParameterError, match="'mesh': efficiency"):
            evaluate(scene, parameters={"efficiency": value})
