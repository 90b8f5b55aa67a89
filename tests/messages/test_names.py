"""Names of parts that are taken, by every kind of part."""

import pytest

from lagrange_casadi import Mechanism
from lagrange_casadi.errors import DeclarationError

BEARERS = {
    "a link": lambda m, name: m.link(name, length=1, mass=1),
    "a point mass": lambda m, name: m.point_mass(name, 1),
    "a joint": lambda m, name: m.weld(
        name, m.links["arm"].tip, m.point_mass(f"end{len(m.bodies)}", 1)
    ),
    "a load": lambda m, name: m.force(name, m.links["arm"], x=1),
    "a constraint": lambda m, name: m.constraint(name, m.coordinate(m.joints["pin"])),
    "a non-holonomic constraint": lambda m, name: m.nonholonomic(
        name, m.rate(m.joints["pin"]), replaces=m.joints["pin"]
    ),
}
TAKERS = {
    kind: BEARERS[f"a {kind}"]
    for kind in ("joint", "load", "constraint", "non-holonomic constraint")
}
TAKERS |= {
    "gear": lambda m, name: m.gear(name, m.joints["pin"], m.joints["pin"], ratio=2),
    "spring": lambda m, name: m.spring(name, m.ground, m.links["arm"].tip, stiffness=1, length=1),
    "torque": lambda m, name: m.torque(name, m.links["arm"], 1),
}
CALLED = {"gear": "constraint", "spring": "load", "torque": "load"}


def arm():
    m = Mechanism("machine")
    m.revolute("pin", m.ground, m.link("arm", length=1, mass=1))
    return m


@pytest.mark.parametrize("taker", TAKERS)
@pytest.mark.parametrize("bearer", BEARERS)
def test_a_taken_name_says_by_what(bearer, taker):
    m = arm()
    BEARERS[bearer](m, "x")
    kind = CALLED.get(taker, taker)
    twice = bearer == f"a {kind}"
    says = (
        "is declared twice in mechanism 'machine'"
        if twice
        else f"the name is taken by {bearer} of mechanism 'machine'"
    )
    with pytest.raises(DeclarationError) as told:
        TAKERS[taker](m, "x")
    assert str(told.value) == f"{kind} 'x'{' ' if twice else ': '}{says}"


@pytest.mark.parametrize("taker", TAKERS)
def test_the_ground_has_its_name(taker):
    with pytest.raises(
        DeclarationError, match="the name is taken by the ground of mechanism 'machine'"
    ):
        TAKERS[taker](arm(), "ground")


def test_no_name_is_reserved():
    for declare in (*BEARERS.values(), lambda m, name: m.parameter(name, 1)):
        for name in ("law", "x_rate", "x_acceleration", "certificate", "all"):
            declare(arm(), name)
