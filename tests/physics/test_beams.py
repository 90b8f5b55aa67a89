"""What links are made of: properties against polygons, quadrature, tables of textbooks; masses, and
what cannot be.
"""

import itertools
import math

import casadi as ca
import numpy as np
import pytest
from internals import Wanted, beam_from_numbers, beam_to_numbers

from lagrange_casadi import Mechanism, Scene, SpatialMechanism, beams, evaluate, motion
from lagrange_casadi.errors import DeclarationError, ParameterError, UnknownNameError

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]

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


@pytest.mark.parametrize("kind", ["i_section", "t_section", "c_section", "box"])
def test_walls_are_the_polygon_of_their_outline(kind):
    found = shapes()[kind].properties()
    corners = corners_of(kind)[::-1] if kind != "box" else corners_of(kind)
    if beams.polygon(corners).area < 0:
        corners = corners[::-1]
    outline = beams.polygon(corners).properties()
    for name in ("area", "iy", "iz"):
        assert getattr(found, name) == pytest.approx(getattr(outline, name), rel=1e-12), name
    assert outline.iyz == pytest.approx(0.0, abs=1e-12 * outline.iz)
    assert max(f.y for f in found.fibres) == pytest.approx(max(f.y for f in outline.fibres))
    assert min(f.y for f in found.fibres) == pytest.approx(min(f.y for f in outline.fibres))
    assert max(f.z for f in found.fibres) == pytest.approx(max(f.z for f in outline.fibres))
    if kind != "box":  # a seam would be two widths
        assert max(f.along_y[0] for f in found.fibres) == pytest.approx(
            outline.fibres[-1].along_y[0], rel=1e-12
        )


def rounded_outline(height, width, radius):
    """The corners of a rectangle with rounded corners, counter-clockwise."""
    angles = np.linspace(0.0, np.pi / 2, 721)
    corners = []
    for k, (i, j) in enumerate(((1, 1), (-1, 1), (-1, -1), (1, -1))):
        turned = angles + k * np.pi / 2
        y = i * (height / 2 - radius) + radius * np.cos(turned)
        z = j * (width / 2 - radius) + radius * np.sin(turned)
        corners += [*zip(y.tolist(), z.tolist(), strict=True)]
    return corners


def test_a_hollow_section_is_the_difference_of_its_outlines():
    found = shapes()["hollow_section"].properties()
    outer, inner = (
        beams.polygon(rounded_outline(*sizes)).properties()
        for sizes in ((H, B, 1.5 * TW), (H - 2 * TW, B - 2 * TW, TW))
    )
    for name in ("area", "iy", "iz"):
        whole = getattr(outer, name) - getattr(inner, name)
        assert getattr(found, name) == pytest.approx(whole, rel=2e-7), name
    # Q / (I b) of each solid outline is at its centroid: Q and the force that the flow carries.
    q = [p.fibres[-1].along_y[0] * p.iz * width for p, width in ((outer, B), (inner, B - 2 * TW))]
    (side,) = (f for f in found.fibres if f.name == "side +z")
    assert side.along_y[0] == pytest.approx((q[0] - q[1]) / (found.iz * 2 * TW), rel=1e-6)
    # Each fibre lies on the outline.
    places = np.array(rounded_outline(H, B, 1.5 * TW))
    for fibre in found.fibres:
        if fibre.name.startswith("corner"):
            assert np.hypot(*(places - [fibre.y, fibre.z]).T).min() < 1e-8, fibre.name


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


@pytest.mark.parametrize("kind", ["rectangle", "ellipse", "tube"])
def test_full_ones_are_their_integrals(kind):
    found = shapes()[kind].properties()
    y, z = np.meshgrid(*[(np.arange(2000) + 0.5) / 2000 * 0.06 - 0.03] * 2, indexing="ij")
    inside = {
        "rectangle": (abs(y) < H / 2) & (abs(z) < B / 2),
        "ellipse": (2 * y / H) ** 2 + (2 * z / B) ** 2 < 1,
        "tube": (np.hypot(y, z) < H / 2) & (np.hypot(y, z) > H / 2 - TW),
    }[kind]
    cell = (0.06 / 2000) ** 2
    for name, integrand in (("area", 1.0), ("iz", y * y), ("iy", z * z)):
        assert getattr(found, name) == pytest.approx(
            float((inside * integrand).sum() * cell), rel=2e-3
        ), name


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


def test_torsion_of_a_rectangle_is_prandtls_function_on_a_grid():
    """A membrane by finite differences: twice its volume, and its slopes in the middles of the
    sides.
    """
    a, b, n = 0.03, 0.02, 120
    hy, hz = a / (3 * n // 2), b / n
    rows, columns = 3 * n // 2 - 1, n - 1
    second = {
        size: 2 * np.eye(size) - np.eye(size, k=1) - np.eye(size, k=-1) for size in (rows, columns)
    }
    (ey, vy), (ez, vz) = (
        np.linalg.eigh(second[size] / step**2) for size, step in ((rows, hy), (columns, hz))
    )
    phi = vy @ ((vy.T @ np.full((rows, columns), 2.0) @ vz) / (ey[:, None] + ez[None])) @ vz.T
    torsion = 2 * phi.sum() * hy * hz
    found = beams.rectangle(a, b).properties()
    assert found.torsion == pytest.approx(torsion, rel=2e-4)
    beside = (4 * phi[rows // 2, 0] - phi[rows // 2, 1]) / (2 * hz)
    above = (4 * phi[0, columns // 2] - phi[1, columns // 2]) / (2 * hy)
    assert max(abs(f.along_y[2]) for f in found.fibres) == pytest.approx(beside / torsion, rel=1e-3)
    assert max(abs(f.along_z[2]) for f in found.fibres) == pytest.approx(above / torsion, rel=1e-3)


@pytest.mark.parametrize("kind", shapes())
def test_dimensions_may_be_expressions(kind):
    shape = shapes()[kind]
    symbols = {name: ca.SX.sym(name) for name in shape.dimensions}
    found = beams.Shape(kind, symbols).properties()
    numbers = shape.properties()
    names = (
        "area",
        "iy",
        "iz",
        "torsion",
        "shear_y",
        "shear_z",
        "wy",
        "wz",
        "centre_y",
        "centre_z",
    )
    f = ca.Function(
        "f", list(symbols.values()), [ca.vertcat(*(ca.SX(getattr(found, name)) for name in names))]
    )
    expected = [float(getattr(numbers, name)) for name in names]
    np.testing.assert_allclose(
        f(*shape.dimensions.values()).full().ravel(), expected, rtol=1e-13, atol=1e-18
    )
    assert shape.area == pytest.approx(numbers.area, rel=1e-14)


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
    assert description["bodies"]["arm"]["mass"] == pytest.approx(
        expected if kind != "given" else STEEL.density * 0.4 * 4.8e-4, rel=1e-13
    )


def test_loads_know_a_thicker_rod():
    m = Mechanism("m")
    d = m.parameter("d", 0.02, "m")
    m.revolute("O", m.ground, m.link("arm", length=0.4, beam=beams.Beam(beams.round_bar(d), STEEL)))
    scene = Scene(m, {"O": motion.polynomial(0.3, 2.0)}, t=(0, 1, 11))
    thin, thick = (evaluate(scene, parameters={"d": x}) for x in (0.02, 0.04))
    np.testing.assert_allclose(thick.effort("O"), 4 * thin.effort("O"), rtol=1e-12)
    assert thick.certified
    steel = math.pi / 4 * 0.02**2 * 0.4 * 7850
    assert thin.effort("O")[0] == pytest.approx(steel * 9.81 * 0.2 * math.cos(0.3), rel=1e-12)


def test_a_mass_of_its_own_beside_the_beam():
    solution = evaluate(
        arm(beams.Beam(beams.rectangle(0.02, 0.01), STEEL), mass=3.0), certificate=False
    )
    assert solution.description["bodies"]["arm"]["mass"] == 3.0
    assert "beam" in solution.description["bodies"]["arm"]


def test_a_beam_is_told_in_numbers_and_back():
    rod = beams.Beam(
        beams.stepped([0.4], [beams.tube(0.03, 0.002), beams.tube(0.03, 0.004)]),
        STEEL,
        [beams.Notch(0.4, 1.5, 1.7)],
        (1, 0.7),
    )
    told = beam_to_numbers(rod, float)
    again = beam_from_numbers(told)
    assert beam_to_numbers(again, float) == told
    for key, value in (
        ("breaks", [0, 1]),
        ("shapes", [{"kind": "exec", "dimensions": {}}] * 2),
        ("columns", [1, -1]),
        ("cells", [[0, 7]] * 2),
    ):
        with pytest.raises((ValueError, LookupError, DeclarationError)):
            beam_from_numbers(told | {key: value})


REFUSED = {
    "wall of its tube": (
        beams.tube(0.02, -0.001),
        r"link 'arm': wall of its tube must be positive, got -0\.001",
    ),
    "thick wall": (
        beams.tube(0.02, 0.012),
        r"link 'arm': inner diameter of its tube must be positive, got -0\.004",
    ),
    "flanges": (
        beams.i_section(0.02, 0.02, 0.004, 0.012),
        "height between the flanges of its i_section must be positive",
    ),
    "web": (
        beams.box(0.02, 0.02, 0.012, 0.004),
        "width beside the webs of its box must be positive",
    ),
    "clockwise": (
        beams.polygon([(0, 0), (0, 1), (1, 0)]),
        "area, of corners counter-clockwise, of its polygon must be",
    ),
    "not a number": (
        beams.rectangle(math.nan, 0.1),
        "height of its cross-section must be finite, got nan",
    ),
    "text": (
        beams.Shape("rectangle", {"height": None, "width": 0.1}),
        "height of its cross-section must be a number or an expression in parameters, got None",
    ),
}


@pytest.mark.parametrize("why", REFUSED)
def test_impossible_cross_sections_are_one_line(why):
    shape, says = REFUSED[why]
    with pytest.raises((DeclarationError, ParameterError), match=says):
        arm(beams.Beam(shape, STEEL))


@pytest.mark.parametrize(
    ("make", "says"),
    [
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
        (lambda: beams.Material("x", -1.0), "material 'x': density must be a positive number"),
        (lambda: beams.Material("x", 1.0, yield_strength=2.0, ultimate=1.0),
            "yield_strength 2 Pa is above ultimate 1 Pa"),
        (lambda: beams.Material("x", 1.0, ultimate=1.0, endurance=0.95),
            r"endurance 0\.95 Pa must be below 0\.9 of the ultimate"),
        (lambda: beams.Material("x", 1.0).needs("a test", "elasticity", "ultimate"),
            "no elasticity and no ultimate, which a"),
        (lambda: beams.material("cheese"), "unknown material 'cheese'; valid: S235"),
    ],
)  # fmt: skip
def test_what_cannot_be_is_one_line(make, says):
    with pytest.raises((DeclarationError, UnknownNameError), match=says):
        make()


def test_links_refuse_what_is_no_beam():
    m = Mechanism("m")
    with pytest.raises(
        DeclarationError, match=r"link 'a': expected a beam of lagrange_casadi\.beams, got 7"
    ):
        m.link("a", length=1.0, beam=7)
    with pytest.raises(
        DeclarationError,
        match="beam= excludes centre= and inertia=, because a link with these has no sections",
    ):
        m.link(
            "a",
            length=1.0,
            mass=1.0,
            centre=(0, 0),
            inertia=1.0,
            beam=beams.Beam(beams.round_bar(0.01), STEEL),
        )
    x = ca.SX.sym("x")
    with pytest.raises(
        DeclarationError, match="diameter of its cross-section depends on 'x', not a parameter"
    ):
        m.link("a", length=1.0, beam=beams.Beam(beams.round_bar(x), STEEL))


def test_in_space_too():
    m = SpatialMechanism("m")
    m.revolute(
        "O",
        m.ground,
        m.link("arm", length=0.4, beam=beams.Beam(beams.round_bar(0.02), STEEL)),
        axis=(0, 1, 0),
    )
    solution = evaluate(Scene(m, {"O": motion.polynomial(0.3, 2.0)}, t=(0, 1, 11)))
    assert solution.certified
    assert solution.description["bodies"]["arm"]["mass"] == pytest.approx(
        math.pi / 4 * 0.02**2 * 0.4 * 7850
    )


def test_every_pair_of_fibres_has_a_name_of_its_own():
    for shape in shapes().values():
        names = [fibre.name for fibre in shape.properties().fibres]
        assert all(a != b for a, b in itertools.combinations(names, 2)), names
    assert Wanted.of(arm(beams.Beam(beams.round_bar(0.02), STEEL)).mechanism, ["effort"]).effort
