"""What makes parts impossible: evaluations, sweeps on every backend and exported C draw the same
line; and links of any density and shape are in balance.
"""

import pytest
from compiled import UNPREPARED, told

from lagrange_casadi import Mechanism, Scene, density, export, sweep, table
from lagrange_casadi.errors import DeclarationError, ParameterError
from lagrange_casadi.motion import polynomial


def arm(build, names, default=0.0):
    """A driven arm whose matter depends on parameters."""
    m = Mechanism("arm")
    symbols = [m.parameter(name, default) for name in names]
    m.revolute("O", m.ground, build(m, *symbols))
    return Scene(m, {"O": polynomial(0.0, 1.0)}, t=(0.0, 1.0, 3))


def rod(coefficients):
    return lambda m, c: m.link("arm", length=0.5, density=density.polynomial(*coefficients(c)))


MATTER = {
    "parabola": rod(lambda c: (1, -1, c)),
    "dips": rod(lambda c: (1, -c, c)),
    "cubic": rod(lambda c: (1, -c, 0, c)),
    "quartic": rod(lambda c: (1, -c, c, 0.5 * c, 0.1 * c)),
    "quintic": rod(lambda c: (0.1, 0, c, 0, -3 * c, 2.05 * c)),
    "line": rod(lambda c: (1, -c)),
    "uniform": lambda m, c: m.link("arm", length=0.5, mass=c),
    "length": lambda m, c: m.link("arm", length=c, density=density.polynomial(1.0, -0.5)),
    "plate": lambda m, c: m.link("arm", length=0.5, mass=1.0, centre=(0.1, 0.0), inertia=c),
    "overflow": lambda m, c: m.link("arm", length=0.5, density=density.polynomial(1.0, 1.0 / c)),
}

VALUES = [
    -30.0,
    -6.0,
    -1.0,
    -1e-3,
    0.0,
    1e-3,
    0.5,
    1.0,
    1.9,
    3.0,
    3.9,
    4.0,
    4.1,
    6.0,
    9.0,
    40.0,
    400.0,
]


def accepted(scene, values):
    found = []
    for c in values:
        try:
            scene.mechanism.values({"c": c})
        except ParameterError:
            found.append(False)
        else:
            found.append(True)
    return found


@pytest.mark.sampled(11)
@pytest.mark.parametrize("name", MATTER)
def test_all_programs_draw_the_same_line(name, tmp_path):
    scene = arm(MATTER[name], ["c"], default=0.25)
    expected = accepted(scene, VALUES)
    assert len(set(expected)) == 2
    tried = (f"parameters.c = {c!r}; {UNPREPARED}" for c in VALUES)
    exported = told(tmp_path, export(scene, tmp_path), *tried)
    assert [status == 0 for status, *_ in exported] == expected
    wanted = ["effort"] if name == "plate" else ["effort", "section:arm"]
    for backend in ("lanes", "c"):
        found = sweep(scene, {"c": VALUES}, wanted=wanted, backend=backend)
        impossible = [found.statuses[int(k)][0] == "impossible" for k in found["status"]]
        assert [not one for one in impossible] == expected


@pytest.mark.parametrize(
    ("says", "declare"),
    {
        "link 'b': expected either mass= or density=": lambda m, a: [
            m.revolute("K", a.tip, m.link("b", length=1)),
            m.freeze(),
        ],
        "expected either mass= or density=": lambda m, a: m.link(
            "b", length=1, mass=1, density=density.uniform(1)
        ),
        "expected mass=, centre= and inertia= together": lambda m, a: m.link(
            "b", length=1, mass=1, centre=(0, 0)
        ),
        "expected a density of lagrange_casadi.density": lambda m, a: m.link(
            "b", length=1, density=3.0
        ),
        "places must increase, but entry 2": lambda m, a: density.tabulated(
            [0, 0.5, 0.5, 1], [1, 1, 1, 1]
        ),
        "must reach from 0 to 1, got 0 to 0.5": lambda m, a: density.tabulated([0, 0.5], [1, 1]),
        "at least one coefficient": lambda m, a: density.polynomial(),
        "table: places must increase": lambda m, a: table(m.time, [0, 1, 1], [1, 2, 3]),
        "table: beyond must be 'hold' or 'line', got 'cubic'": lambda m, a: table(
            m.time, [0, 1], [1, 2], beyond="cubic"
        ),
        "load 'F': expected a link": lambda m, a: m.force("F", "nothing", x=1),
        "another mechanism": lambda m, a: m.force(
            "F", Mechanism("n").link("z", length=1, mass=1), x=1
        ),
        "load 'F' is declared twice": lambda m, a: [m.force("F", a, x=1), m.force("F", a, x=1)],
        "load 'J': the name is taken by a joint of mechanism 'm'": lambda m, a: m.force(
            "J", a, x=1
        ),
        "point mass 'p' cannot take a torque; expected a link": lambda m, a: m.torque(
            "T", m.point_mass("p", 1), 1.0
        ),
        "constraint 'c' depends on no coordinate": lambda m, a: m.constraint("c", 3.0),
        "depends on no coordinate": lambda m, a: m.constraint("c", m.time * 2),
        "depends on rates": lambda m, a: m.constraint(
            "c", m.coordinate(m.joints["J"]) * m.rate(m.joints["J"])
        ),
        "must be linear": lambda m, a: m.nonholonomic(
            "r", m.rate(m.joints["J"]) ** 2, replaces=m.joints["J"]
        ),
        "depends on no rate": lambda m, a: m.nonholonomic("r", m.time, replaces=m.joints["J"]),
        "expected a joint of mechanism 'm', got 'J'; joints: J": lambda m, a: m.coordinate("J"),
        "joint 'W' has no coordinate": lambda m, a: m.coordinate(
            m.weld("W", a.tip, m.point_mass("p", 1))
        ),
        "which has no direction for the weld": lambda m, a: m.weld("W", m.point_mass("p", 1), a),
        "a force on the ground has no effect": lambda m, a: m.force("F", m.ground, x=1),
        "axis must be two components": lambda m, a: m.prismatic(
            "P", m.ground, m.point_mass("p", 1), axis=1
        ),
        "joint 'a': the name is taken by a link of": lambda m, a: m.revolute("a", m.ground, a.tip),
        "'J': the name is taken by a joint": lambda m, a: m.constraint(
            "J", m.coordinate(m.joints["J"])
        ),
        "non-holonomic constraint 's': 'r' already replaces the drive of joint 'J'": lambda m, a: [
            m.nonholonomic(n, m.rate(m.joints["J"]), replaces=m.joints["J"]) for n in "rs"
        ],
    }.items(),
)
def test_misuse_is_named(declare, says):
    m = Mechanism("m")
    a = m.link("a", length=1, mass=1)
    m.revolute("J", m.ground, a)
    with pytest.raises(DeclarationError, match=says):
        declare(m, a)


@pytest.mark.parametrize(
    ("matter", "says"),
    [
        (
            {"density": density.polynomial(1.0, -3.0)},
            r"density must not be negative, got -2 kg/m at xi/l = 1",
        ),
        (
            {"density": density.polynomial(1.0, -5.0, 5.0)},
            r"density must not be negative, got -0\.25 kg/m at xi/l = 0\.5",
        ),
        (
            {"density": density.tabulated([0, 0.5, 0.7, 1], [1, -1, 1, -3])},
            r"got -3 kg/m at xi/l = 1",
        ),
        ({"mass": 1.0, "centre": (0, 0), "inertia": -1.0}, "inertia must not be negative"),
    ],
)
def test_impossible_links_are_named(matter, says):
    m = Mechanism("m")
    m.revolute("J", m.ground, m.link("a", length=1, **matter))
    with pytest.raises(ParameterError, match=says):
        Scene(m, {"J": polynomial(0)})
