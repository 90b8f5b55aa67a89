"""Cross-sections and materials: properties against polygons, quadrature, textbooks and another
program; concentration of stress; and what cannot be.
"""

from __future__ import annotations

import math
import sys

import casadi as ca
import numpy as np
import pytest
import strong

from lagrange_casadi import Mechanism, Scene, beams, evaluate, motion
from lagrange_casadi.errors import (
    DeclarationError,
    LagrangeCasadiError,
    ParameterError,
    UnknownNameError,
)

pytestmark = pytest.mark.usefixtures("interpreted")

H, B, TW, TF = 0.05, 0.03, 0.004, 0.006


def corners_of(kind):
    """The same sections as polygons (y, z), those with a hole cut open along a seam."""
    h, b = H / 2, B / 2
    if kind == "i_section":
        half = [(h, b), (h, -b), (h - TF, -b), (h - TF, -TW / 2)]
        return [
            *half,
            *((-y, z) for y, z in reversed(half)),
            *((-y, -z) for y, z in half),
            *((y, -z) for y, z in reversed(half)),
        ]
    if kind == "t_section":
        return [
            (H, b),
            (H, -b),
            (H - TF, -b),
            (H - TF, -TW / 2),
            (0, -TW / 2),
            (0, TW / 2),
            (H - TF, TW / 2),
            (H - TF, b),
        ]
    if kind == "c_section":
        return [
            (h, B),
            (h, 0),
            (-h, 0),
            (-h, B),
            (-h + TF, B),
            (-h + TF, TW),
            (h - TF, TW),
            (h - TF, B),
        ]
    y, z = h - TF, b - TW
    return [(h, b), (h, -b), (-h, -b), (-h, b), (h, b), (y, z), (-y, z), (-y, -z), (y, -z), (y, z)]


def shapes():
    return {
        "i_section": beams.i_section(H, B, TW, TF),
        "t_section": beams.t_section(H, B, TW, TF),
        "c_section": beams.c_section(H, B, TW, TF),
        "box": beams.box(H, B, TW, TF),
        "hollow_section": beams.hollow_section(H, B, TW, 1.5 * TW, TW),
        "rectangle": beams.rectangle(H, B),
        "ellipse": beams.ellipse(H, B),
        "tube": beams.tube(H, TW),
    }


def test_a_round_ellipse_is_a_tube_without_a_bore():
    ellipse, tube = (shape.properties() for shape in (beams.ellipse(H, H), beams.tube(H, H / 2)))
    around = [fibre for fibre in ellipse.fibres if fibre.name != "centre"]
    told = [tube.shear_y, tube.shear_z, tube.torsion, *np.ravel([f.along_z for f in tube.fibres])]
    found = [ellipse.shear_y, ellipse.shear_z, ellipse.torsion]
    found += [*np.ravel([fibre.along_z for fibre in around])]
    assert found == pytest.approx(told, rel=1e-12, abs=1e-12 * max(told))


@pytest.mark.parametrize("kind", ["i_section", "t_section", "c_section", "box"])
def test_walls_are_the_polygon_of_their_outline(kind):
    found = shapes()[kind].properties()
    corners = corners_of(kind)[::-1] if kind != "box" else corners_of(kind)
    if beams.polygon(corners).area < 0:
        corners = corners[::-1]
    outline = beams.polygon(corners).properties()
    for name in ("area", "iy", "iz"):
        told = getattr(outline, name)
        assert getattr(found, name) == pytest.approx(told, rel=1e-12, abs=0.0), name
    assert outline.iyz == pytest.approx(0.0, abs=1e-12 * outline.iz)
    assert max(f.y for f in found.fibres) == pytest.approx(max(f.y for f in outline.fibres))
    assert min(f.y for f in found.fibres) == pytest.approx(min(f.y for f in outline.fibres))
    assert max(f.z for f in found.fibres) == pytest.approx(max(f.z for f in outline.fibres))
    if kind != "box":  # a seam would be two widths
        assert max(f.along_y[0] for f in found.fibres) == pytest.approx(
            outline.fibres[-1].along_y[0], rel=1e-12
        )


@pytest.mark.parametrize(
    ("kind", "along_y", "along_z"),
    [
        ("i_section", (H - TF) * TW, 5 / 6 * 2 * B * TF),
        ("t_section", H * TW, 5 / 6 * B * TF),
        ("c_section", (H - TF) * TW, 5 / 6 * 2 * B * TF),
        ("box", 2 * (H - TF) * TW, 2 * (B - TW) * TF),
        ("hollow_section", 2 * (H - TW) * TW, 2 * (B - TW) * TW),
    ],
)
def test_walls_along_a_force_carry_it(kind, along_y, along_z):
    """Areas of Timoshenko's beam, as books have them: webs between the middles of flanges, of
    flanges five sixths, of boxes the walls.
    """
    found = shapes()[kind].properties()
    assert (found.shear_y, found.shear_z) == pytest.approx((along_y, along_z), rel=1e-12)


def test_shear_in_the_middle_of_a_polygon_is_that_of_its_shape():
    """Along both axes: a rectangle's, half as much again as the mean."""
    corners = [(H / 2, B / 2), (-H / 2, B / 2), (-H / 2, -B / 2), (H / 2, -B / 2)]
    middle = beams.polygon(corners).properties().fibres[-1]
    assert (middle.along_y[0], middle.along_z[1]) == pytest.approx((1.5 / (H * B),) * 2, rel=1e-12)


def test_shear_flows_of_a_thin_hollow_section_carry_the_force_and_the_torsion():
    """The flow goes along the wall, and its sum along y is the force."""
    t, radius = 2e-4, 6e-3
    shape = beams.hollow_section(H, B, t, radius + t / 2, radius - t / 2)
    fibres = {fibre.name: fibre for fibre in shape.properties().fibres}
    corner = [fibres[f"corner +y +z, {angle:g} deg"] for angle in np.arange(5) * 22.5]
    at = np.radians(np.arange(5) * 22.5)
    flows = np.array([fibre.along_y[:1] + fibre.along_z[:1] for fibre in corner])
    size = np.hypot(*flows.T)
    along = np.column_stack([np.sin(at), -np.cos(at)])
    assert flows == pytest.approx(size[:, None] * along, rel=1e-12, abs=1e-12 * size.max())
    # Both by rules that are exact for cubics: straight sides, and corners by their five fibres.
    side = fibres["side +z"].along_y
    web = (H - t - 2 * radius) * (2 * size[-1] + 4 * side[0]) / 6
    arc = radius * np.pi / 24 * ([1, 4, 2, 4, 1] * size * np.sin(at)).sum()
    assert (2 * web + 4 * arc) * t == pytest.approx(1.0, rel=1e-3)
    inside = (H - t) * (B - t) - (4 - math.pi) * radius**2
    # Bredt's stress, and that of the wall's own twist, G t theta.
    length = 2 * (H + B - 2 * t) - 2 * (4 - math.pi) * radius
    assert 2 * inside * t * -side[2] == pytest.approx(1 + t * length / (2 * inside), rel=1e-3)


@pytest.mark.parametrize(
    ("kind", "flanges"), [("i_section", 2), ("c_section", 2), ("t_section", 1)]
)
def test_thin_open_walls_twist_as_textbooks_say(kind, flanges):
    """Timoshenko, Strength of Materials II: the sum of l t^3/3 over the walls; of a box Bredt's
    4 A^2 t/l.
    """
    t = 1e-4
    found = getattr(beams, kind)(H, B, t, t).properties().torsion
    assert found == pytest.approx((H + flanges * B) * t**3 / 3, rel=1e-2, abs=0.0)
    box = beams.box(H + t, B + t, t, t).properties().torsion
    assert box == pytest.approx(4 * (H * B) ** 2 / (2 * (H + B) / t), rel=1e-2)


@pytest.mark.parametrize("kind", ["i_section", "t_section", "c_section"])
def test_twist_goes_round_open_walls_with_the_moment(kind):
    """Prandtl: along the outline, counterclockwise, thickness over torsion constant."""
    found, corners = shapes()[kind].properties(), np.array(corners_of(kind))
    if beams.polygon([*map(tuple, corners)]).area < 0:
        corners = corners[::-1]
    furthest = [max(f.y for f in found.fibres), max(f.z for f in found.fibres)]
    corners = corners + furthest - corners.max(axis=0)
    sides = np.roll(corners, -1, axis=0) - corners
    twisted = 0
    for fibre in found.fibres:
        twist, at = np.array([fibre.along_y[2], fibre.along_z[2]]), np.array([fibre.y, fibre.z])
        if not twist.any():
            continue
        across = [abs(a * z - b * y) for (a, b), (y, z) in zip(sides, at - corners, strict=True)]
        there = [side / np.hypot(*side) for side, x in zip(sides, across, strict=True) if x < 1e-15]
        thickness = TW if twist[0] else TF
        assert any(side @ twist * found.torsion == pytest.approx(thickness) for side in there)
        twisted += 1
    assert twisted >= 4


@pytest.mark.parametrize(
    ("ratio", "constant", "modulus"),
    # Timoshenko and Goodier, Theory of Elasticity, table of art. 109: k1 and k2.
    [
        (1.0, 0.1406, 0.208),
        (1.5, 0.196, 0.231),
        (2.0, 0.229, 0.246),
        (3.0, 0.263, 0.267),
        (5.0, 0.291, 0.291),
    ],
)
def test_torsion_of_rectangles_is_the_textbooks(ratio, constant, modulus):
    found = beams.rectangle(0.01 * ratio, 0.01).properties()
    assert found.torsion == pytest.approx(constant * ratio * 1e-8, rel=3e-3)
    stress = max(abs(fibre.along_y[2]) for fibre in found.fibres)
    assert 1 / stress == pytest.approx(modulus * ratio * 1e-6, rel=3e-3)
    turned = beams.rectangle(0.01, 0.01 * ratio).properties()
    assert turned.torsion == pytest.approx(found.torsion, rel=1e-14)
    assert max(abs(fibre.along_z[2]) for fibre in turned.fibres) == pytest.approx(stress, rel=1e-13)


def test_the_shear_centre_of_a_thin_c_is_the_textbooks():
    """Roark's 3 b^2 / (h + 6 b) beyond the web's middle, for walls of one thickness, b and h
    between middles.
    """
    t, b, h = 1e-5, 0.02, 0.05
    found = beams.c_section(h + t, b + t / 2, t, t).properties()
    back = -min(fibre.z for fibre in found.fibres)
    assert -(found.centre_z + back - t / 2) == pytest.approx(3 * b**2 / (h + 6 * b), rel=1e-3)


def arm(beam, **more):
    m = Mechanism("m")
    m.revolute("O", m.ground, m.link("arm", length=0.4, beam=beam, **more))
    return Scene(m, {"O": motion.polynomial(0.3, 2.0)}, t=(0, 1, 11))


STEEL = beams.material("S355")


@pytest.mark.parametrize("kind", [*shapes(), "given"])
def test_mass_follows_from_area_and_density_along_a_taper(kind):
    """Against Gauss's quadrature of the areas between, which are of degree two."""
    start = shapes().get(kind) or beams.given(6e-4, 1e-7, 2e-8, top=0.02, side=0.01)
    stop = start.mapped(lambda _, value: 0.6 * value)
    course = beams.along([0, 0.3, 0.3, 1], [start, stop, start, stop])
    places, weights = np.polynomial.legendre.leggauss(3)
    areas = [
        start.mapped(lambda _, value, s=s: value * (1 - 0.4 * s)).area for s in (places + 1) / 2
    ]
    expected = STEEL.density * 0.4 * float(np.dot(weights / 2, areas))
    description = evaluate(arm(beams.Beam(course, STEEL)), certificate=False).description
    assert description.bodies["arm"].mass == pytest.approx(
        expected if kind != "given" else STEEL.density * 0.4 * 4.8e-4, rel=1e-13
    )


CORNERS = [(0.0, 0.0), (0.05, 0.0), (0.05, 0.03), (0.0, 0.03)]


SQUARE = beams.polygon(CORNERS)


def of(shape):
    return lambda: arm(beams.Beam(shape, STEEL))


@pytest.mark.parametrize(
    ("make", "says"),
    [
        (of(beams.tube(0.02, -0.001)),
            r"link 'arm': wall of its tube must be positive, got -0\.001"),
        (of(beams.tube(0.02, 0.012)),
            r"link 'arm': inner diameter of its tube must be positive, got -0\.004"),
        (of(beams.i_section(0.02, 0.02, 0.004, 0.012)),
            "height between the flanges of its i_section must be positive"),
        (of(beams.box(0.02, 0.02, 0.012, 0.004)),
            "width beside the webs of its box must be positive"),
        (of(beams.polygon([(0, 0), (0, 1), (1, 0)])),
            "area, of corners counter-clockwise, of its polygon must be"),
        (of(beams.rectangle(math.nan, 0.1)),
            "height of its cross-section must be finite, got nan"),
        (of(beams.Shape("rectangle", {"height": None, "width": 0.1})),
            "height of its cross-section must be a number or an expression in .*, got None"),
        (of(beams.round_bar(ca.SX.sym("x"))),
            "diameter of its cross-section depends on 'x', not a parameter"),
        (lambda: arm(7), r"link 'arm': expected a beam of lagrange_casadi\.beams, got 7"),
        (lambda: arm(beams.Beam(SQUARE, STEEL), mass=1, centre=(0, 0), inertia=1.0),
            "beam= excludes centre= and inertia=, because a link with these has no sections"),
        (lambda: beams.along([0, 0.5], [beams.round_bar(1)] * 2),
            r"ratios must rise from 0 to 1, got 0, 0\.5"),
        (lambda: beams.along([0, 1], [beams.round_bar(1), beams.rectangle(1, 1)]),
            "cannot become a rectangle; put a step"),
        (lambda: beams.along([0, 1], [1, 2]), "along: shapes: expected a list, each a Shape"),
        (lambda: beams.stepped([0.5], [beams.round_bar(1)]),
            "one step fewer than shapes, got 1 steps and 1 shapes"),
        (lambda: beams.polygon([(0, 1)]), "three corners or more, got 1"),
        (lambda: beams.Beam(3, STEEL), "shape: expected a Shape or a Course, got 3"),
        (lambda: beams.Beam(beams.round_bar(1), "steel"),
            "material: expected a Material, got 'steel'"),
        (lambda: beams.Beam(beams.round_bar(1), STEEL, [1.5]),
            "notches: expected a list, each a Notch"),
        (lambda: beams.Beam(beams.round_bar(1), STEEL, columns=(1, 0)),
            "two effective lengths, positive"),
        (lambda: beams.Notch(1.2), "Notch: at: expected a number from 0 to 1, got 1.2"),
        (lambda: beams.Notch(0.2, bending=0.5),
            "Notch: bending: expected a number of at least 1, got 0.5"),
        (lambda: beams.Notch(0.2, sensitivity=2),
            "Notch: sensitivity: expected a number from 0 to 1, got 2"),
        (lambda: beams.Material("x", -1.0), "Material 'x': density: expected a positive number"),
        (lambda: beams.Material("x", 1.0, yield_strength=2.0, ultimate=1.0),
            "yield_strength 2 Pa is above ultimate 1 Pa"),
        (lambda: beams.Material("x", 1.0, ultimate=1.0, endurance=0.95),
            r"endurance 0\.95 Pa must be below 0\.9 of the ultimate"),
        (lambda: beams.Material("x", 1.0).needs("a test", "elasticity", "ultimate"),
            "no elasticity and no ultimate, which a"),
        (lambda: beams.material("cheese"), "unknown material 'cheese'; valid: S235"),
        (lambda: beams.analysed(beams.rectangle(0.05, 0.03)),
            "expected a polygon whose corners are numbers, got a rectangle"),
        (lambda: beams.analysed(CORNERS), "expected a polygon, or a Section of sectionproperties"),
        (lambda: beams.shoulder(0.5, 0.02, 0.03, 0.001),
            "shoulder: wide must be more than narrow, got 0.02 and 0.03 m"),
        (lambda: beams.shoulder(0.5, 0.03, 0.02, -1.0),
            r"shoulder: radius: expected a positive number \[m\], or a text such as .*, got -1"),
        (lambda: beams.shoulder(0.5, 0.03, 0.02, 0.0001, flat=True),
            "for tension the depth .* from 0.1 to 20, got 50"),
        (lambda: beams.shoulder(0.5, 0.03, 0.02, 0.001),
            "for torsion the depth .* from 0.25 to 4, got 5, or give its factor as shear"),
        (lambda: beams.hole(0.5, 0.02, 0.02), "hole: diameter must be less than height"),
        (lambda: beams.sensitivity(0.001, 100e6),
            "ultimate strength of 345 to 1724 MPa, got 100 MPa"),
        (lambda: beams.keyway(1.5), "Notch: at: expected a number from 0 to 1"),
    ],
)  # fmt: skip
def test_what_cannot_be_is_one_line(make, says):
    with pytest.raises((DeclarationError, ParameterError, UnknownNameError), match=says):
        make()


def test_a_rectangle_is_its_closed_form():
    pytest.importorskip("sectionproperties")
    found, exact = beams.analysed(SQUARE), beams.rectangle(0.05, 0.03).properties()
    properties = found.properties(space=True)
    for name in ("area", "iy", "iz", "wy", "wz"):
        assert getattr(properties, name) == pytest.approx(getattr(exact, name), rel=1e-9)
    assert properties.torsion == pytest.approx(exact.torsion, rel=1e-3)
    twist = max(abs(fibre.along_y[2]) + abs(fibre.along_z[2]) for fibre in exact.fibres)
    assert 1 / found.dimensions["torsion_modulus"] == pytest.approx(twist, rel=5e-3)
    assert 1 / found.dimensions["shear_y"] == pytest.approx(1.5 / exact.area, rel=0.02)


def test_what_lacks_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "sectionproperties", None)
    with pytest.raises(LagrangeCasadiError, match=r"pip install 'lagrange_casadi\[sections\]'"):
        beams.analysed(SQUARE)


# Norton, Machine Design, 2nd edition, figures E-1 to E-3: K = A (r/d)^b of round shafts with a
# shoulder, fits of older charts. Those of bending are lower by up to a twelfth.
NORTON = {
    "axial": (0.05, {1.2: (0.96272, -0.25527), 1.5: (0.99957, -0.28221), 2.0: (1.01470, -0.30035)}),
    "bending": (
        0.08,
        {1.2: (0.97098, -0.21796), 1.5: (0.93836, -0.25759), 2.0: (0.90879, -0.28598)},
    ),
    "shear": (
        0.05,
        {1.2: (0.83425, -0.21649), 1.33: (0.84897, -0.23161), 2.0: (0.86331, -0.23865)},
    ),
}


@pytest.mark.parametrize("load", NORTON)
@pytest.mark.parametrize("radius", [0.05, 0.1, 0.2])
def test_round_shoulders_are_those_of_another_fit(load, radius):
    apart, fits = NORTON[load]
    for ratio, (a, b) in fits.items():
        told = 0.25 <= (ratio - 1) / 2 / radius <= 4
        if load != "shear" or told:
            found = beams.shoulder(0.5, ratio, 1.0, radius, shear=None if told else 1.0)
            assert getattr(found, load) == pytest.approx(a * radius**b, rel=apart)


# Young and Budynas, Roark's Formulas for Stress and Strain, 7th edition, table 17.1: C1 to C4 by 1,
# sqrt(h/r) and h/r, up to h/r = 2 and beyond, fits of the same charts made anew; whether the bar is
# flat, the load, and h/r.
ROARK = {
    (True, "axial", 1.0): (
        (1.007, 1.000, -0.031),
        (-0.114, -0.585, 0.314),
        (0.241, -0.992, -0.271),
        (-0.134, 0.577, -0.012),
    ),
    (True, "axial", 5.0): (
        (1.042, 0.982, -0.036),
        (-0.074, -0.156, -0.010),
        (-3.418, 1.220, -0.005),
        (3.450, -2.046, 0.051),
    ),
    (True, "bending", 1.0): (
        (1.007, 1.000, -0.031),
        (-0.270, -2.404, 0.749),
        (0.677, 1.133, -0.904),
        (-0.414, 0.271, 0.186),
    ),
    (True, "bending", 5.0): (
        (1.042, 0.982, -0.036),
        (-3.599, 1.619, -0.431),
        (6.084, -5.607, 1.158),
        (-2.527, 3.006, -0.691),
    ),
    (False, "axial", 1.0): (
        (0.927, 1.149, -0.086),
        (0.011, -3.029, 0.948),
        (-0.304, 3.979, -1.737),
        (0.366, -2.098, 0.875),
    ),
    (False, "axial", 5.0): (
        (1.225, 0.831, -0.010),
        (-1.831, -0.318, -0.049),
        (2.236, -0.522, 0.176),
        (-0.630, 0.009, -0.117),
    ),
    (False, "bending", 1.0): (
        (0.927, 1.149, -0.086),
        (0.015, -3.281, 0.837),
        (0.847, 1.716, -0.506),
        (-0.790, 0.417, -0.246),
    ),
    (False, "bending", 5.0): (
        (1.225, 0.831, -0.010),
        (-3.790, 0.958, -0.257),
        (7.374, -4.834, 0.862),
        (-3.809, 3.046, -0.595),
    ),
}


@pytest.mark.parametrize("flat_load_depth", ROARK)
@pytest.mark.parametrize("ratio", [1.05, 1.2, 1.5, 2.0])
def test_shoulders_are_those_of_roarks_fit(flat_load_depth, ratio):
    flat, load, depth = flat_load_depth
    share = (ratio - 1) / ratio
    roark = sum(
        (a + b * depth**0.5 + c * depth) * share**k
        for k, (a, b, c) in enumerate(ROARK[flat_load_depth])
    )
    found = beams.shoulder(0.5, ratio, 1.0, (ratio - 1) / 2 / depth, flat=flat, shear=1.0)
    assert getattr(found, load) == pytest.approx(roark, rel=0.02)


def test_a_solved_problem_of_a_textbook():
    """Shigley, 9th edition, example 6-6: from 38 to 32 mm by 3 mm, 690 MPa; read from charts K_t =
    1.65, q = 0.84, K_f = 1.55.
    """
    q = beams.sensitivity(0.003, 690e6)
    notch = beams.shoulder(0.5, 0.038, 0.032, 0.003, sensitivity=q)
    assert notch.bending == pytest.approx(1.65, rel=0.025)
    assert q == pytest.approx(0.84, abs=0.01)
    assert 1 + q * (notch.bending - 1) == pytest.approx(1.55, rel=0.025)


def test_a_hole_has_howlands_factors():
    """Howland, Phil. Trans. R. Soc. A 229 (1930), by series; a small hole has Kirsch's 3."""
    for share, exact in (
        (1e-6, 3.0),
        (0.1, 3.03),
        (0.2, 3.14),
        (0.3, 3.36),
        (0.4, 3.74),
        (0.5, 4.32),
    ):
        assert beams.hole(0.5, 1.0, share).axial == pytest.approx(exact, rel=0.004)
    assert beams.hole(0.5, 1.0, 1e-6).bending == pytest.approx(1.0, abs=1e-5)
    assert beams.hole(0.5, 1.0, 0.4).bending == pytest.approx(1 / (1 - 0.4**3))
    assert beams.hole(0.5, 1.0, 0.8).bending == pytest.approx(2 * 0.8 / (1 - 0.8**3))


def test_the_narrow_side_of_a_step_has_the_stress():
    shape = beams.stepped([0.5], [beams.round_bar(0.03), beams.round_bar(0.02)])
    notch = beams.shoulder(0.5, 0.03, 0.02, 0.004)
    stress = evaluate(strong.press(shape, [notch], t=(0, 0.2, 5)), certificate=False).stress("rod")
    narrow = stress.at(0.5, "tip", notch)[0]
    assert abs(stress.peak("normal", notches=True).value) == pytest.approx(
        abs(narrow).max(), rel=1e-12
    )
    assert abs(narrow).max() > abs(stress.at(0.5, "base", notch)[0]).max()


def test_a_keyway_is_the_tables():
    assert (beams.keyway(0.2).bending, beams.keyway(0.2).shear) == (2.14, 3.0)
