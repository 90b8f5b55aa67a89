"""The case of a SCARA arm whose motion is read from a file: against a closed form, and against the
S-curves in the file.
"""

import numpy as np
import pytest
from conftest import CASES

from lagrange_casadi import Scene, evaluate, load_case
from lagrange_casadi.motion import dwell, move, moves

pytestmark = pytest.mark.usefixtures("interpreted")


def efforts(solution):
    """The efforts of both motors by the closed form of textbooks on robots, in absolute angles of
    the two arms.
    """
    first, second = solution.motion("shoulder"), solution.motion("motor")
    lever = 0.35 * (4.0 * 0.15 + 3.0 * 0.3)
    inner = 6.0 * 0.35**2 / 3 + (4.0 + 3.0) * 0.35**2
    outer = 4.0 * 0.3**2 / 3 + 3.0 * 0.3**2
    bent = second.value - first.value
    yield inner * first.acceleration + lever * (
        np.cos(bent) * second.acceleration - np.sin(bent) * second.rate**2
    )
    yield (outer + 1e-3) * second.acceleration + lever * (
        np.cos(bent) * first.acceleration + np.sin(bent) * first.rate**2
    )


@pytest.mark.parametrize("pace", [1.0, 1.7])
def test_efforts_are_those_of_the_closed_form(pace):
    solution = evaluate(load_case(CASES / "scara").scene, parameters={"pace": pace})
    assert solution.certified
    for joint, expected in zip(("shoulder", "motor"), efforts(solution), strict=True):
        assert solution.effort(joint) == pytest.approx(
            expected, rel=0, abs=1e-12 * np.abs(expected).max()
        )


def test_the_file_is_as_good_as_the_moves_that_it_was_made_from():
    scene = load_case(CASES / "scara").scene

    def played(start, end):
        out = move(f"{end} deg", time=0.47, law="s_curve")
        back = move(f"{start} deg", time=0.43, law="s_curve")
        return moves(
            [dwell(0.08), out, dwell(0.12), back, dwell(0.1)], start=f"{start} deg", cyclic=True
        )

    exact = Scene(
        scene.mechanism,
        {"shoulder": played(10, 95), "motor": played(70, 160)},
        t=scene.t,
        posture=scene.posture,
    )
    found, expected = evaluate(scene, parameters={"pace": 1.0}), evaluate(exact)
    for joint in ("shoulder", "motor"):
        assert (
            np.degrees(np.abs(found.motion(joint).value - expected.motion(joint).value)).max()
            < 0.002
        )
        gap = found.effort(joint) - expected.effort(joint)
        size = np.abs(expected.effort(joint)).max()
        assert np.abs(gap).max() < 0.03 * size
        assert np.sqrt(np.mean(gap**2)) < 0.006 * size
