"""Random mechanisms whose joints rub: right by vector Newton-Euler with the law iterated around it,
or refused as they jam.
"""

import pytest
import rubbing
from oracle import FORCES
from random_friction import RUB, rubbed
from random_verdict import peaks_off

from lagrange_casadi import evaluate
from lagrange_casadi.errors import AssemblyError
from lagrange_casadi.peaks import forces

pytestmark = pytest.mark.usefixtures("interpreted")


def compare(made):
    """The largest gap of efforts, reactions and frictions over the largest of their kind; None
    where it jams.
    """
    drawn, scene = made.drawn, made.scene()
    d, size = drawn.draft, drawn.draft.oracle(drawn.draft.start).size
    parameters = drawn.keywords.get("parameters")
    values = scene.mechanism.values(parameters)
    worst = 0.0
    for t in made.t:
        try:
            solution = evaluate(scene, parameters=parameters, t=(t, t, 1))
        except AssemblyError as error:
            if "jams" not in str(error):
                raise
            return None
        assert solution.certified
        exact = rubbing.solve(d.oracle(t), scene.mechanism, values, d.drives(t), drawn.path.near(t))
        named = {f"effort:{name}": x for name, x in exact.efforts.items()} | exact.frictions
        named |= {
            f"reaction:{name}:{k}": x
            for name, xs in exact.reactions.items()
            for k, x in zip(FORCES, xs, strict=True)
        }
        largest = max(
            abs(x) / (size if name.endswith(":mz") else 1.0)
            for name, x in named.items()
            if name.startswith("reaction")
        )
        assert exact.frictions
        fastest = max(1.0, *(abs(y.d) for q in exact.q.values() for y in q))
        for name, x in named.items():
            if name in solution.series:
                unit = max(1.0, size) * (fastest if name.endswith("loss") else 1.0)
                worst = max(worst, abs(float(solution.series[name][0]) - x) / (largest * unit))
    return worst


@pytest.mark.sampled(4)
@pytest.mark.parametrize("seed", RUB)
def test_right_or_refused(seed):
    made = rubbed(seed)
    worst = compare(made)
    assert worst is None or worst < 1e-10, f"{worst}\n{made.source}"


DENSE = 2001


def keeps_peaks(made):
    """Peaks between instants are those of many instants, though what frictions compare is all
    rounding.
    """
    scene = made.scene()
    parameters, (start, stop, _) = made.drawn.keywords.get("parameters"), made.drawn.grid
    try:
        solution, dense = (
            evaluate(scene, parameters=parameters, t=(start, stop, n), certificate=False)
            for n in (made.drawn.grid[2], DENSE)
        )
    except AssemblyError as error:
        if "jams" not in str(error):
            raise
        return
    names = [*forces(solution), *(name for name in solution.names() if name.endswith(":loss"))]
    off = peaks_off(scene, solution, dense, names)
    assert not off, "\n".join([*off, made.source])


@pytest.mark.parametrize(
    "seed", [pytest.param(seed, marks=[pytest.mark.long] * (seed not in (46, 80))) for seed in RUB]
)
def test_every_peak_is_found(seed):
    keeps_peaks(rubbed(seed))
