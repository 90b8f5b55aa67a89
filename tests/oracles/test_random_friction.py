"""Random mechanisms whose joints rub: right by vector Newton-Euler with the law iterated around it,
or refused as they jam.
"""

import math
from dataclasses import dataclass

import numpy as np
import pytest
import rubbing
from internals import DesignEngine, EvaluationMethod, Status, forces, search
from oracle import FORCES
from random_mechanisms import draw
from random_verdict import is_regular

from lagrange_casadi import evaluate, refine
from lagrange_casadi.errors import AssemblyError

pytestmark = pytest.mark.usefixtures("interpreted")

SEEDS = range(120)
# fmt: off
RUB = [
    0, 4, 7, 8, 11, 15, 16, 18, 19, 22, 26, 30, 31, 36, 38, 39, 41, 43, 46, 49, 54, 62, 65, 66, 67,
    68, 71, 76, 80, 86, 90, 91, 92, 98, 101, 103, 105, 108, 109, 113, 115, 117,
]
# fmt: on
"""Those of which something rubs."""
_RUBS, _INSTANTS = 3, 3
_STEADY = 0.05


@dataclass(frozen=True)
class Rubbed:
    """A random mechanism with friction: its source, where it is looked at, and the draft that the
    oracle is made of.
    """

    source: str
    t: tuple[float, ...]
    drawn: object

    def scene(self):
        space: dict = {}
        exec(compile(self.source, "random mechanism that rubs", "exec"), space)
        return space["scene"]


def rubbed(seed):
    """Friction in up to three joints of a regular mechanism that moves, and whose reactions are all
    told; None for others.
    """
    drawn, rng = draw(seed), np.random.default_rng((seed, 77))
    smoothed = np.random.default_rng((seed, 82))
    d = drawn.draft
    if (
        not is_regular(drawn)
        or drawn.grid[2] < 2
        or drawn.path.steadiness < _STEADY
        or "wanted" in drawn.keywords
    ):
        return None
    times = np.linspace(*drawn.grid[:2], _INSTANTS + 2)[1:-1].tolist()
    results = [d.oracle(t).solve(d.drives(t), drawn.path.near(t)) for t in times]
    if any(result.open or result.vague for result in results):
        return None
    size, lines = d.oracle(d.start).size, []
    joints = [
        j
        for name, j in d.joints.items()
        if name in d.movable() and (j.slides or all(_oriented(d, p) for p in _ends(j)))
    ]
    for joint in (joints[k] for k in rng.permutation(len(joints))[:_RUBS]):
        rates = [
            abs(rubbing.Rub(joint).rate(d.oracle(t).places(r)))
            for t, r in zip(times, results, strict=True)
        ]
        if min(rates) < 1e-3 * max(rates) or min(rates) < 1e-6:
            continue
        numbers = {"mu": rng.uniform(0.0, 0.15)}
        if not joint.slides:
            numbers["radius"] = size * rng.uniform(0.002, 0.03)
        elif joint.kind == "prismatic" and all(_oriented(d, point) for point in _ends(joint)):
            numbers["length"] = size * rng.uniform(0.3, 0.9)
        if rng.random() < 0.3:
            numbers |= {"static": rng.uniform(0.05, 0.2), "stribeck": rng.uniform(0.05, 1.0)}
        if rng.random() < 0.3:
            numbers["viscous"] = rng.uniform(0.0, 2.0)
        if smoothed.random() < 0.15:
            numbers["smooth"] = smoothed.uniform(0.2, 2.0) * max(rates)
        told = ", ".join(f"{word}={float(number)!r}" for word, number in numbers.items())
        lines.append(f'm.friction("rub_{joint.name}", m.joints["{joint.name}"], {told})')
    if not lines:
        return None
    before, scene = drawn.source.split("scene = Scene(", 1)
    return Rubbed(
        "\n".join([before.rstrip(), *lines, f"scene = Scene({scene}"]), tuple(times), drawn
    )


def _ends(joint):
    return joint.parent[0], joint.child[0]


def _oriented(d, body):
    return body == "ground" or d.bodies[body].oriented


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


@pytest.mark.sampled(8)
@pytest.mark.parametrize("seed", RUB)
def test_right_or_refused(seed):
    made = rubbed(seed)
    worst = compare(made)
    assert worst is None or worst < 1e-10, f"{worst}\n{made.source}"


@pytest.mark.long
def test_many_of_them_rub_and_few_jam():
    assert [seed for seed in SEEDS if rubbed(seed) is not None] == RUB
    made = [rubbed(seed) for seed in RUB]
    assert sum(compare(one) is None for one in made) < len(made) / 4
    assert math.isfinite(max(worst for one in made if (worst := compare(one)) is not None))


DENSE = 4001


def keeps_peaks(made, monkeypatch):
    """Peaks between instants are those of many instants, found in few panels, though what frictions
    compare is all rounding.
    """
    scene, panels = made.scene(), []
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
    one = search._Search.interval
    monkeypatch.setattr(search._Search, "interval", lambda *given: panels.append(1) or one(*given))
    names = [*forces(solution), *(name for name in solution.names() if name.endswith(":loss"))]
    peaks = refine(scene, solution, names)
    assert len(panels) < search.INTERVALS / 8
    largest = {
        unit: max(abs(dense.peak(name).value) for name in names if dense.unit(name) == unit)
        for unit in map(dense.unit, names)
    }
    for peak in peaks:
        size, many = largest[peak.unit], abs(dense.peak(peak.name).value)
        assert many - 1e-9 * size <= abs(peak.value) <= many * 1.01 + 1e-2 * size, (
            f"{peak}, {many}\n{made.source}"
        )


@pytest.mark.parametrize("seed", [46, 80])
def test_peaks_are_found_where_comparisons_are_rounding(seed, monkeypatch):
    keeps_peaks(rubbed(seed), monkeypatch)


def test_designs_tell_peaks_where_an_acceleration_is_rounding():
    """Designs know no rounding: their graph has no kink at an acceleration that is zero by the
    shape of the mechanism.
    """
    scene = rubbed(46).scene()
    found = DesignEngine.of(scene, ["effort"], method=EvaluationMethod("vm")).evaluate(
        [list(scene.mechanism.values().values())]
    )
    assert found.status.tolist() == [Status.OK]


@pytest.mark.long
@pytest.mark.parametrize("seed", RUB)
def test_every_peak_is_found(seed, monkeypatch):
    keeps_peaks(rubbed(seed), monkeypatch)
