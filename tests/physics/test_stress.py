"""Stresses against sums over the cross-section, and their largest ones against fine grids."""

from __future__ import annotations

import math

import numpy as np
import pytest
import strong

from lagrange_casadi import Mechanism, Scene, beams, evaluate, motion
from lagrange_casadi.errors import DeclarationError, UnknownNameError

pytestmark = pytest.mark.usefixtures("interpreted")

I = beams.i_section(0.03, 0.02, 0.003, 0.004)


SHAPES = {
    "even": I,
    "tapered": beams.tapered(
        beams.box(0.05, 0.03, 0.003, 0.004), beams.box(0.02, 0.03, 0.003, 0.004)
    ),
    "sharp": beams.tapered(beams.rectangle(0.04, 0.02), beams.rectangle(0.003, 0.002)),
    "stepped": beams.stepped([0.5], [beams.tube(0.04, 0.003), beams.tube(0.03, 0.003)]),
    "leaning": beams.polygon([(0.0, 0.0), (0.03, 0.005), (0.035, 0.03), (0.01, 0.02)]),
}

KINDS = {"normal": (1, 0), "shear": (0, 1), "von_mises": (1, 3), "tresca": (1, 4)}
"""Weights of the squares of normal and shear stress.
"""


@pytest.fixture(scope="module")
def solutions():
    return {
        name: evaluate(
            strong.press(shape, sliding=name == "even", t=(0, 0.2, 25)), certificate=False
        )
        for name, shape in SHAPES.items()
    }


@pytest.mark.sampled(7)
@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("name", SHAPES)
def test_the_largest_is_that_of_a_fine_grid(solutions, name, kind):
    stress = solutions[name].stress("rod")
    grid = np.abs(stress.grid(kind, np.linspace(0.0, 1.0, 801))).max(axis=1)
    found = stress.largest(kind)
    peak = stress.peak(kind)
    size = abs(peak.value)
    gaps = np.abs(found.value) - grid
    # No place of the grid is above what was found; the grid misses summits by the square of its
    # step, and jumps by a step.
    assert gaps.min() >= -1e-11 * size
    assert gaps.max() <= 8e-3 * size
    assert size == pytest.approx(np.abs(found.value).max(), rel=1e-13)
    k = int(np.argmin(np.abs(stress.member.t - peak.t)))
    there = [
        stress.at(peak.xi, side)[:, stress.fibres(peak.xi, side).index(peak.fibre), k]
        for side in ("base", "tip")
    ]
    squares = [KINDS[kind][0] * s**2 + KINDS[kind][1] * (y**2 + z**2) for s, y, z in there]
    if kind == "normal":
        assert np.sign(peak.value) == np.sign(there[int(np.argmax(squares))][0])
        assert found.value.min() < 0.0 < found.value.max()
    assert math.sqrt(max(squares)) == pytest.approx(size, rel=1e-9 if name != "even" else 1e-6)


@pytest.mark.parametrize("name", ["even", "leaning"])
def test_normal_stresses_make_up_the_forces(solutions, name):
    """Over the corners' own plane: axial force and both moments are integrals of it, by triangles
    of the outline.
    """
    solution = solutions[name]
    stress, section = solution.stress("rod"), solution.section("rod").law
    u = np.full((solution.t.size, 1), 0.41)
    values = stress.at(0.41)[0]
    properties = stress.member.cross.properties(0, 0.41)
    places = np.array([(1.0, f.y, f.z) for f in properties.fibres])
    plane, rest, _, _ = np.linalg.lstsq(places, values, rcond=None)
    assert rest.size == 0 or rest.max() < 1e-18 * np.abs(values).max() ** 2
    force, about_z = section.at("axial", u)[:, 0], section.at("bending", u)[:, 0]
    np.testing.assert_allclose(
        plane[0] * properties.area, force, rtol=1e-9, atol=1e-9 * np.abs(force).max()
    )
    np.testing.assert_allclose(
        -(plane[1] * properties.iz + plane[2] * properties.iyz),
        about_z,
        rtol=1e-9,
        atol=1e-9 * abs(about_z).max(),
    )
    none = plane[1] * properties.iyz + plane[2] * properties.iy
    assert np.abs(none).max() < 1e-9 * np.abs(about_z).max()


@pytest.mark.parametrize(
    "kind", ["i_section", "t_section", "c_section", "box", "rectangle", "tube"]
)
def test_shear_stresses_carry_the_shear_force(kind):
    """Jourawski's stress summed over slices of the outline is the force; at the fibres it is what
    the closed forms say.
    """
    h, b, t = 0.05, 0.03, 0.004
    shape = {"rectangle": beams.rectangle(h, b), "tube": beams.tube(h, t)}.get(kind) or getattr(
        beams, kind
    )(h, b, t, t)
    p = shape.properties()
    top, bottom = max(f.y for f in p.fibres), min(f.y for f in p.fibres)
    edges = np.linspace(bottom, top, 20001)
    y, step = (edges[1:] + edges[:-1]) / 2, edges[1] - edges[0]
    if kind == "tube":
        width = 2 * np.sqrt((h / 2) ** 2 - y**2) - 2 * np.sqrt(
            np.maximum((h / 2 - t) ** 2 - y**2, 0.0)
        )
    else:
        flange = (y > top - t) | ((y < bottom + t) & (kind not in ("t_section",)))
        width = (
            np.where(flange, b, 2 * t if kind == "box" else t)
            if kind != "rectangle"
            else np.full_like(y, b)
        )
    first = np.cumsum((y * width)[::-1])[::-1] * step
    stress = first / (p.iz * width)
    assert (stress * width).sum() * step == pytest.approx(1.0, rel=2e-3)
    # Of a tube the whole width is a place of it on the middle line alone.
    inside = [
        f
        for f in p.fibres
        if f.along_y[0] > 0 and (abs(f.y) < 1e-9 if kind == "tube" else abs(f.y) < 0.999 * top)
    ]
    assert inside
    for fibre in inside:
        k = min(int(np.searchsorted(y, fibre.y)), y.size - 2)
        assert fibre.along_y[0] == pytest.approx(stress[k - 2 : k + 2].max(), rel=5e-3), fibre.name


def test_notches_take_their_factors():
    solution = evaluate(
        strong.press(I, [beams.Notch(0.25, axial=2.0, bending=3.0, shear=1.5)]), certificate=False
    )
    stress = solution.stress("rod")
    notch = stress.member.beam.notches[0]
    plain, local = stress.at(0.25), stress.at(0.25, "tip", notch)
    ends = np.full((solution.t.size, 1), 0.25)
    axial = solution.section("rod").law.at("axial", ends)[:, 0] / I.area
    np.testing.assert_allclose(
        local[0] - 2.0 * axial, 3.0 * (plain[0] - axial), rtol=1e-12, atol=1e-3
    )
    np.testing.assert_allclose(local[1:], 1.5 * plain[1:], rtol=1e-12)
    peak = stress.peak("normal", notches=True)
    assert (peak.xi, peak.notch, abs(peak.value)) == (
        0.25,
        True,
        pytest.approx(np.abs(local[0]).max()),
    )


@pytest.mark.parametrize(
    ("ask", "says"),
    [
        (lambda: strong.press(I), ("rod", "von", "unknown kind of stress 'von'")),
        (lambda: strong.press(I), ("crank", "von_mises", "has no beam=; links with a beam: rod")),
        (
            lambda: strong.robot(SHAPES["leaning"]),
            ("upper", "von_mises", "carries torsion, and there is no formula for a polygon; use b"),
        ),
    ],
)
def test_what_has_no_stress(ask, says):
    link, kind, words = says
    solution = evaluate(ask(), t=(0, 0.2, 5), certificate=False)
    with pytest.raises((DeclarationError, UnknownNameError), match=words):
        solution.stress(link).peak(kind)


def test_a_beam_that_tapers_in_two_parts_is_worst_where_its_modulus_says():
    """A load F across the tip of a bar of height h(u): 6 F l (1 - u) / (b h^2)."""
    m, b, places, heights = Mechanism("held"), 0.02, [0.0, 0.5, 1.0], [0.06, 0.04, 0.012]
    course = beams.along(places, [beams.rectangle(h, b) for h in heights])
    bar = m.link("bar", length=0.3, beam=beams.Beam(course, beams.material("S235")))
    m.revolute("O", m.ground, bar)
    m.force("load", bar.tip, x=0.0, y=4e3)
    m.set_gravity(0.0, 0.0)
    scene = Scene(m, {"O": motion.polynomial(0.0)}, t=(0, 0, 1), wanted=["section:bar"])
    u = np.linspace(0, 1, 100_001)
    worst = (6 * 4e3 * 0.3 * (1 - u) / (b * np.interp(u, places, heights) ** 2)).max()
    found = evaluate(scene, backend="vm").stress("bar").largest("von_mises")
    assert found.value == pytest.approx([worst], rel=1e-8)
