"""Sizing: against trying every profile, and what cannot be sized."""

import math

import pytest
from mechanisms import pendulum, pins_of
from strong import BARS, arms

from lagrange_casadi import Mechanism, Scene, beams, evaluate, size
from lagrange_casadi.beams import Profile, read_profiles
from lagrange_casadi.errors import DeclarationError, NoDesignError, UnknownNameError
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.usefixtures("interpreted")


@pytest.fixture(scope="module")
def scene():
    return arms()


@pytest.fixture(scope="module")
def sized(scene):
    return size(scene, BARS, safety=2.0)


def safe(scene, d1, d2):
    solution = evaluate(scene, parameters={"d1": d1, "d2": d2}, certificate=False)
    return min(solution.safety(link).factor for link in ("upper", "fore")) >= 2.0


def test_every_link_is_safe_and_none_alone_can_be_lighter(scene, sized):
    chosen = {one.link: one.profile.dimensions["diameter"] for one in sized.links}
    assert sized.parameters == {"d1": chosen["upper"], "d2": chosen["fore"]}
    assert sized.solution.certified
    assert safe(scene, *chosen.values())
    diameters = [profile.dimensions["diameter"] for profile in BARS]
    upper, fore = (max(d for d in diameters if d < chosen[link]) for link in ("upper", "fore"))
    assert not safe(scene, upper, chosen["fore"])
    assert not safe(scene, chosen["upper"], fore)
    for one in sized.links:
        assert one.safety == sized.solution.safety(one.link)
        assert one.mass == pytest.approx(
            7850
            * math.pi
            / 4
            * one.profile.dimensions["diameter"] ** 2
            * (0.5 if one.link == "upper" else 0.4)
        )
        profile, found = one.lighter
        assert profile.dimensions["diameter"] < one.profile.dimensions["diameter"]
        assert found.factor < 2.0 <= one.safety.factor
    assert sized.mass == pytest.approx(sum(one.mass for one in sized.links))
    assert sized.left == {"plate": "diameter is not a dimension of its rectangle"}


def test_a_link_may_be_left_as_it_is(scene):
    found = size(scene, BARS, links=["fore"], parameters={"d1": 0.025})
    assert [one.link for one in found.links] == ["fore"]
    assert set(found.parameters) == {"d2"}
    assert found.solution.description.parameters["d1"].value == 0.025


def test_a_link_is_stiff(scene):
    found = size(
        scene, BARS, links=["fore"], parameters={"d1": 0.02}, t=(0, 1 / 1.5, 5), deflection=1 / 350
    )
    (fore,) = found.links
    bent = abs(found.solution.deflection("fore").peak().value)
    assert bent <= 0.4 / 350
    assert fore.safety.governs.against == "deflection"
    assert fore.safety.factor == pytest.approx(0.4 / 350 / bent, rel=1e-12)
    assert fore.lighter[1].factor < 1.0


@pytest.mark.parametrize(
    ("arguments", "error", "says"),
    [
        ({"profiles": []}, DeclarationError, "expected at least one profile"),
        ({"safety": 0.0}, DeclarationError, r"size: safety: expected a positive number, got 0\.0"),
        ({"deflection": -0.1}, DeclarationError,
            r"size: deflection: expected a positive number, got -0\.1"),
        ({"links": ["leg"]}, UnknownNameError, "unknown link with a beam 'leg'"),
        ({"links": ["plate"]}, DeclarationError,
            "link 'plate': diameter is not a dimension of its rectangle"),
        ({"profiles": [Profile("x", {"wall": 1.0})]}, DeclarationError,
            "no link; upper: wall is not a dimension of its round_bar"),
        ({"profiles": [Profile("x", {"diameter": 0.5})]}, DeclarationError,
            r"'x': parameter 'd1' = 0\.5 m is out of its range"),
        ({"profiles": [Profile("x", {"height": 0.5})], "links": ["plate"]}, DeclarationError,
            "its height must be a parameter"),
        ({"safety": 50.0}, NoDesignError,
            "link 'upper': no profile has a factor of 50; the most, 'bar 22', has .* against fat"),
        ({"deflection": 1e-4}, NoDesignError,
            r"a deflection of 0\.0001 of its length at most; the most, 'bar 22', has"),
        ({"scene": pendulum(polynomial(0.0))}, DeclarationError,
            "size: no link has a cross-section, so there is nothing to size"),
        ({"scene": arms(shared=True)}, DeclarationError,
            "links 'upper' and 'fore' share parameter 'd1'; give each its own"),
    ],
)  # fmt: skip
def test_what_cannot_be_sized(scene, arguments, error, says):
    with pytest.raises(error, match=says):
        size(**{"scene": scene, "profiles": BARS, **arguments})


@pytest.fixture
def two_beams():
    m = Mechanism("two_beams")
    height, width = m.parameter("h", 0.08, "m", low=0.0), m.parameter("b", 0.04, "m", low=0.0)
    web = m.parameter("web", 0.005, "m", low=0.0)
    material = beams.material("S355")
    section = beams.i_section(height, width, web, m.parameter("flange", 0.007, "m", low=0.0))
    first = m.link("first", length=0.5, beam=beams.Beam(section, material))
    flat = beams.rectangle(m.parameter("h2", 0.05, "m"), m.parameter("b2", 0.02, "m"))
    second = m.link("second", length=0.5, beam=beams.Beam(flat, material))
    pins_of(m, O=(m.ground, first), A=(first.tip, second))
    still = polynomial(0.3)
    return Scene(m, {"O": still, "A": still}, t=(0, 1, 3))


def test_a_standard_table_fits_a_whole_cross_section(two_beams):
    found = size(two_beams, read_profiles("flat"))
    assert [one.link for one in found.links] == ["second"]
    assert found.left == {"first": "table 'flat' has no web, flange of its i_section"}
    bars = [Profile(f"{h} mm", {"height": h / 1e3, "width": 0.04}) for h in (10, 60)]
    words = "height between the flanges of its i_section must be positive, got -0.004"
    assert size(two_beams, bars).left == {"first": f"profile '10 mm': {words}"}
