"""Expressions that are at a single place other than on both sides of it: no instant there is a
result.
"""

import itertools

import casadi as ca
import numpy as np
import pytest
from drawn_curves import T, cam, constraint, shown, slide, told_by_limits
from internals import DesignEngine, Smooth, Status
from operations import EACH, X, Y

from lagrange_casadi import Mechanism, Scene, evaluate, prepare, refine
from lagrange_casadi.errors import AssemblyError, DeclarationError
from lagrange_casadi.motion import polynomial

pytestmark = [pytest.mark.quick, pytest.mark.usefixtures("interpreted")]

TOUCHING = T * ca.sin(T)
"""Zero at zero alone, to the last bit; CasADi does not simplify its size, as it does that of a
square.
"""

INNER = [
    *(a + b * TOUCHING for a, b in itertools.product((0.0, 1.0, -1.0, 0.5, 1.5), (1.0, -1.0))),
    *(T, 2 * T, ca.cos(T), ca.sin(T), 1 + T),
]
OTHER = [ca.SX(0), ca.SX(1), ca.SX(-1), 1 + T, T, -TOUCHING, 0.5 + TOUCHING]
OUTER = [lambda f: f, lambda f: f**2, lambda f: (1 + T) * f + ca.sin(T)]


def expressions():
    for (name, operation), x, y, outer in itertools.product(EACH.items(), INNER, OTHER, OUTER):
        if ca.depends_on(operation, Y) or y is OTHER[0]:
            yield name, ca.SX(outer(ca.substitute(operation, ca.vertcat(X, Y), ca.vertcat(x, y))))


HIT, BESIDE = np.linspace(-0.2, 0.2, 21)[None], np.linspace(-0.2, 0.2, 20)[None]


def compare(some):
    """What is said of zero, where an instant hits it and where none does, with what limits say."""
    many = {}
    for name, program in some:
        told = told_by_limits(program, 0.0) if ca.depends_on(program, T) else None
        if told in (None, "kink"):
            continue
        smooth = Smooth.of(program, T, ca.SX(0, 1))
        found = [None] * 3
        if smooth is not None:
            found = [
                smooth.isolated(HIT, ()),
                smooth.isolated(BESIDE, (), between=True),
                smooth.isolated(BESIDE, ()),
            ]
            kink = smooth.kink(HIT, ())
            # What limits say of zero, they say of zero alone.
            assert kink is None or (
                abs(kink.at["t"]) > 0.1 and shown(program, 0.0, kink.at["t"], -1.0)
            ), f"{name}: {program}: {kink}"
        alone = told == "isolated"
        assert [one is not None for one in found] == [alone, alone, False], (
            f"{name}: {program}: {told}, {found}"
        )
        assert not alone or abs(found[0].at["t"]) < 1e-6
        many.setdefault(told, set()).add(name)
    return many


@pytest.mark.parametrize(
    "program",
    [ca.fmin(ca.sin(T), T), ca.fmax(1 + ca.sin(T), 1 + T), ca.if_else(ca.tan(T) > T, ca.sin(T), T)],
)
def test_curves_that_touch_in_a_third_power_are_no_place_alone(program):
    """They are the same number for some 1e-5 around, at whose ends no curvature is that of either
    side to the last bit.
    """
    smooth = Smooth.of(program, T, ca.SX(0, 1))
    for path in (HIT, BESIDE, 1e-3 * HIT, 30 * BESIDE):
        assert smooth.isolated(path, (), between=True) is None


def test_every_operation_is_looked_at_where_it_touches():
    many = compare(list(expressions())[::61])
    assert len(many["smooth"]) > 25
    assert len(many["isolated"]) > 5


@pytest.mark.long
@pytest.mark.parametrize("part", range(8))
def test_more_expressions(part):
    compare(list(expressions())[part::8])


LAWS = {
    "fabs": lambda x: ca.fabs(x * ca.sin(x)),
    "fmax": lambda x: ca.fmax(x**2, 0),
    "if_else": lambda x: ca.if_else(x == 0, 1, ca.sin(x) / x),
    "floor": lambda x: ca.floor(ca.cos(x)),
    "sign": lambda x: ca.sign(x) ** 2,
    "fmod": lambda x: ca.fmod(2 - ca.sin(x) ** 2, 1),
}


def slid(law, count=21):
    return slide(lambda x, k: 0.1 * law(x - k), (-1.0, 1.0, count))


def held(law, count=21):
    return constraint(lambda x, k: 0.1 * law(x - k), (-1.0, 1.0, count))


def lifted(law, count=21):
    return cam(lambda x, k: 0.01 * law(ca.sin(x - 0.5 - k)), (-1.0, 1.0, count))


NAMED = {
    slid: "the motion of joint 'way'",
    held: "constraint 'profile'",
    lifted: "cam 'profile': its lift",
}
SCENES = pytest.mark.parametrize("scene", NAMED, ids=[one.__name__ for one in NAMED])


@SCENES
@pytest.mark.parametrize("name", LAWS)
def test_an_instant_that_hits_it_is_refused_by_name(scene, name):
    made = scene(LAWS[name])
    with pytest.raises(
        DeclarationError,
        match=f"{NAMED[scene]}: its .* = 0(.5)? differs from its values on both sides",
    ):
        evaluate(made, certificate=False)
    # Nobody is there.
    evaluate(made, parameters={"k": 0.03}, certificate=False)
    evaluate(made, t=(-0.95, 0.95, 20), certificate=False)


@SCENES
@pytest.mark.parametrize("count", [21, 20])
def test_designs_are_sought_between_instants_and_refused_there_too(scene, count):
    made = scene(LAWS["if_else"], count)
    assert DesignEngine.of(made, ["effort"]).evaluate([[0.0], [1.2]]).status.tolist() == [
        Status.CORNER,
        Status.OK,
    ]
    f = prepare(made, wanted=["effort"])
    with pytest.raises((DeclarationError, AssemblyError)):
        f.peaks(k=0.0)
    f.peaks(k=1.2)


@SCENES
def test_peaks_between_instants_are_not_those_of_a_place_alone(scene):
    """-2 x^2 of a lift has its curvature at zero too; an instant there has none, and so has more
    weight left.
    """
    made = scene(lambda x: -2 * ca.if_else(x == 0, 0, x**2 + 0.3 * x**4), 20)
    solution = evaluate(made, certificate=False)
    with pytest.raises(DeclarationError, match="differs from its values on both sides"):
        refine(made, solution)
    assert np.isfinite(
        refine(made, evaluate(made, parameters={"k": 1.2}, certificate=False))[0].value
    )


@pytest.mark.parametrize("t", [(0.0, 0.0, 1), (0.0, 1.0, 11), (-1.0, 0.0, 11)])
def test_the_first_instant_the_last_and_a_single_one_are_looked_at(t):
    with pytest.raises(
        DeclarationError, match="curvature where t = 0 differs from its values on both sides"
    ):
        evaluate(slid(LAWS["fabs"]), t=t, certificate=False)


def test_what_lies_between_both_sides_of_a_jump_of_acceleration_stays():
    for law in (
        lambda x: ca.fmax(x, 0) ** 2,
        lambda x: x * ca.fabs(x),
        lambda x: ca.if_else(x < 0, 0, x**2),
    ):
        evaluate(slid(law), certificate=False)


def test_a_rest_is_no_place_alone():
    evaluate(slid(lambda x: ca.fmax(ca.fabs(x) - 0.55, 0) ** 3), certificate=False)


@pytest.mark.parametrize("name", LAWS)
def test_loads_act_at_an_instant_as_they_are_declared(name):
    """Nothing of them is differentiated: what is said of an instant is so."""
    m = Mechanism("loaded")
    body = m.point_mass("body", 2.0)
    m.prismatic("way", m.ground, body, axis=(1, 0))
    m.force("push", body, x=LAWS[name](m.time))
    solution = evaluate(
        Scene(m, {"way": polynomial(0.0, 1.0)}, t=(-1.0, 1.0, 21), wanted=("effort",))
    )
    declared = ca.Function("law", [T], [ca.SX(LAWS[name](T))])
    np.testing.assert_allclose(
        solution.effort("way"), -declared(solution.t[None]).full().ravel(), atol=1e-15
    )
