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

from lagrange_casadi import evaluate, prepare
from lagrange_casadi.errors import AssemblyError, DeclarationError

pytestmark = pytest.mark.usefixtures("interpreted")

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


def expressions(part):
    """Some of all: to make all takes longer than to look at some."""
    every = [
        (name, operation, *inner)
        for name, operation in EACH.items()
        for inner in itertools.product(
            INNER, OTHER if ca.depends_on(operation, Y) else OTHER[:1], OUTER
        )
    ]
    for name, operation, x, y, outer in every[part]:
        yield name, ca.SX(outer(ca.substitute(operation, ca.vertcat(X, Y), ca.vertcat(x, y))))


HIT, BESIDE = np.linspace(-0.2, 0.2, 21)[None], np.linspace(-0.2, 0.2, 20)[None]


def compare(some):
    """What is said of zero, where an instant hits it and where none does, with what limits say."""
    many = {}
    for name, program in some:
        told = told_by_limits(program, 0.0) if ca.depends_on(program, T) else None
        if told in (None, "kink"):
            continue
        if name in ("eq", "ne"):
            with pytest.raises(DeclarationError, match="by == or !="):
                Smooth.of("the law", program, T, ca.SX(0, 1))
            continue
        smooth = Smooth.of("the law", program, T, ca.SX(0, 1))
        found = [None] * 3
        if smooth is not None:
            kink = smooth.kink(HIT, (), at=False)
            # What limits say of zero, they say of zero alone.
            assert kink is None or (
                abs(kink.place[0]) > 0.1 and shown(program, 0.0, kink.place[0], -1.0)
            ), f"{name}: {program}: {kink}"
            if kink is not None:
                continue
            found = [
                smooth.kink(HIT, ()),
                smooth.kink(BESIDE, (), between=True),
                smooth.kink(BESIDE, ()),
            ]
        alone = told == "isolated"
        assert [one is not None for one in found] == [alone, alone, False], (
            f"{name}: {program}: {told}, {found}"
        )
        assert not alone or (found[0].alone and abs(found[0].place[0]) < 1e-6)
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
    smooth = Smooth.of("the law", program, T, ca.SX(0, 1))
    for path in (HIT, BESIDE, 1e-3 * HIT, 30 * BESIDE):
        found = smooth.kink(path, (), between=True)
        assert found is None or not found.alone


@pytest.mark.parametrize(
    "part",
    [
        slice(0, None, 61),
        *(pytest.param(slice(k, None, 8), marks=pytest.mark.long) for k in range(8)),
    ],
)
def test_every_operation_is_looked_at_where_it_touches(part):
    many = compare(expressions(part))
    assert len(many["smooth"]) > 25
    assert len(many["isolated"]) > 5


LAWS = {
    "fabs": lambda x: ca.fabs(x * ca.sin(x)),
    "fmax": lambda x: ca.fmax(x**2, 0),
    "if_else": lambda x: ca.if_else(ca.logic_and(x <= 0, x >= 0), 1, ca.sin(x) / x),
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
def test_comparisons_that_hold_at_single_instants_are_refused_by_name(scene):
    made = scene(lambda x: ca.if_else(x == 0, 1, ca.sin(x) / x))
    with pytest.raises(DeclarationError, match=f"{NAMED[scene]}: it compares .* by == or !="):
        evaluate(made)


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
