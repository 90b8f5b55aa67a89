"""Internal forces of many mechanisms against vector Newton-Euler on free bodies, which shares
nothing with the package.
"""

import numpy as np
import pytest
from balance import compare
from mechanisms import INSTANT, MOTION, PATTERNS, four_bar, truss_platform

from lagrange_casadi import Mechanism, Scene, derive, evaluate

TOLERANCE = 1e-12


@pytest.mark.parametrize("name", PATTERNS)
def test_every_force_against_newton_euler(name):
    worst, gap = compare(PATTERNS[name]())
    assert gap < TOLERANCE, worst


def test_loops_without_closed_form_against_newton_euler():
    scene = truss_platform()
    program = derive(scene)
    assert program.newton is not None
    worst, gap = compare(scene, t=0.0, nudge=0.003)
    assert gap < TOLERANCE, worst


def test_parent_and_child_exchanged_are_the_same_mechanism():
    """The reaction changes its sign with the roles, nothing else changes."""
    plain, turned = (
        evaluate(four_bar(turned=t), backend="vm") for t in ((False, False), (True, True))
    )
    for joint, sign in (("O", 1), ("A", -1), ("C", -1)):
        np.testing.assert_allclose(
            plain.reaction(joint).fx, sign * turned.reaction(joint).fx, rtol=1e-12
        )
        np.testing.assert_allclose(
            plain.reaction(joint).fy, sign * turned.reaction(joint).fy, rtol=1e-12
        )
    np.testing.assert_allclose(plain.effort("O"), turned.effort("O"), rtol=1e-12)
    # The coupler runs from the other end: its tip is where its base was.
    for force, sign in (("axial", 1), ("shear", 1), ("bending", -1)):
        one, two = plain.array(f"section:b:{force}"), turned.array(f"section:b:{force}")
        np.testing.assert_allclose(one, sign * two[:, ::-1], atol=1e-12 * np.max(np.abs(one)))


def test_declaration_order_does_not_matter():
    def declare(order):
        m = Mechanism("order")
        parts = {"b": (0.35, 0.5), "c": (0.25, 0.4), "a": (0.1, 0.3)}
        links = {n: m.link(n, length=parts[n][0], mass=parts[n][1]) for n in order}
        joints = {
            "O": lambda: m.revolute("O", m.ground, links["a"]),
            "A": lambda: m.revolute("A", links["a"].tip, links["b"]),
            "B": lambda: m.revolute("B", links["b"].tip, links["c"].tip),
            "C": lambda: m.revolute("C", m.ground.at(0.3, 0.05), links["c"]),
        }
        for name in sorted(joints, reverse=order == "cba"):
            joints[name]()
        return evaluate(
            Scene(m, {"O": MOTION}, posture={"c": 1.5, "b": 0.5}, t=(INSTANT, 1, 3)), backend="vm"
        )

    one, two = declare("abc"), declare("cba")
    for name in one.names():
        scale = np.max(np.abs(one.array(name)), initial=1e-3)
        np.testing.assert_allclose(
            one.array(name), two.array(name), atol=1e-12 * scale, err_msg=name
        )
