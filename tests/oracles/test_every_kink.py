"""Motions, constraints, lifts and loads of all operations, at places drawn anew: refused where they
have a kink, and only there.
"""

import functools

import casadi as ca
import numpy as np
import pytest
from drawn_curves import K, T, cam, constraint, drawn, shown, slide, told_by_limits, verdict
from internals import DesignEngine, Smooth, Status

from lagrange_casadi import Mechanism, Scene, evaluate
from lagrange_casadi.errors import AssemblyError, DeclarationError
from lagrange_casadi.motion import polynomial

pytestmark = pytest.mark.usefixtures("interpreted")

VALUES = (0.0, 0.3, 1.0)
TIMES = np.linspace(0.0, 1.0, 4001)[None]


@functools.cache
def judged(seed):
    """A drawn expression, a value of its parameter, whether it is broken, and its values; None
    where that is not clear.
    """
    r = np.random.default_rng(seed)
    program, k = drawn(r), float(r.choice(VALUES))
    if not ca.depends_on(program, T):
        return None
    found = verdict(program, k)
    return (
        (program, k, found.what == "broken", found.values)
        if found.what in ("smooth", "broken")
        else None
    )


def lifted(law):
    """A lift of something that runs from 0 to 1 as the cam turns by half a turn."""
    return cam(lambda x, k: law((1 + ca.sin(x)) / 2, k), turn=polynomial("-90 deg", np.pi))


def refused(scene, seeds):
    """Put drawn expressions into a scene: for the parameter in use, and beside a value that may be
    another verdict.
    """
    many = {True: 0, False: 0}
    for seed in seeds:
        case = judged(seed)
        if case is None:
            continue
        program, k, broken, values = case
        # Small beside the mechanism, and not so small that it is nothing.
        scaled = program * (0.01 / max(np.abs(values[0]).max(), 1e-3))
        law = ca.Function("law", [T, K], [scaled])
        try:
            made = scene(law)
        except DeclarationError:
            # A profile that is undercut for the default.
            continue
        said = f"seed {seed}: {program} with k = {k}"
        try:
            smooth = Smooth.of("the law", program, T, K)
        except DeclarationError:
            with pytest.raises(DeclarationError, match="by == or !="):
                DesignEngine.of(made, ["effort"])
            continue
        status = DesignEngine.of(made, ["effort"]).evaluate(np.array([[0.7], [k]])).status[1]
        try:
            evaluate(made, parameters={"k": k}, backend="vm", certificate=False)
            told = False
        except DeclarationError as error:
            told = "its value" in str(error) or "its slope" in str(error)
        except AssemblyError:
            # A loop that does not close at an instant says nothing of kinks.
            continue
        # Designs are looked at between instants too, where a place alone is hit by none.
        lone = (
            None
            if told or status != Status.CORNER
            else smooth.kink(TIMES, (k,), between=True, at=False)
        )
        assert (
            told
            or status != Status.CORNER
            or told_by_limits(scaled, k, lone.place[0]) == "isolated"
        ), f"{said}: {lone}"
        # A design may be refused for something else before its corners are looked for.
        assert not told or status != Status.OK, said
        if status in (Status.OK, Status.CORNER) and (told or broken):
            place = smooth and smooth.kink(TIMES, (k,), at=False)
            assert told == broken or (
                told and place is not None and shown(program, k, place.place[0])
            ), said
        many[broken] += 1
    return many


def parts(few, first, size, count):
    """Seeds that are drawn always, and parts of many more."""
    more = (range(first + size * k, first + size * (k + 1)) for k in range(count))
    return [pytest.param(few, id="few"), *(pytest.param(s, marks=pytest.mark.long) for s in more)]


@pytest.mark.parametrize("seeds", parts([*range(100, 104), 2187], 5000, 50, 4))
@pytest.mark.parametrize("scene", [slide, constraint, lifted])
def test_scenes_refuse_what_has_a_kink_and_nothing_else(scene, seeds):
    assert min(refused(scene, seeds).values()) >= 1


@pytest.mark.parametrize("seeds", parts(range(200, 204), 6000, 50, 4))
def test_loads_of_all_operations_keep_their_peaks(seeds):
    """A slide that runs steadily is loaded: its effort is the load, whose largest value is not
    missed between instants.
    """
    loaded = 0
    for seed in seeds:
        case = judged(seed)
        if case is None:
            continue
        program, k, _, values = case
        law = ca.Function("law", [T, K], [program])
        m = Mechanism("loaded")
        body, p = m.point_mass("body", 2.0), m.parameter("k", 0.0)
        m.prismatic("way", m.ground, body, axis=(1, 0))
        m.force("push", body, x=law(m.time, p))
        scene = Scene(m, {"way": polynomial(0.0, 1.0)}, t=(0.0, 1.0, 101), wanted=("effort",))
        found = DesignEngine.of(scene, ["effort"]).evaluate(np.array([[k]]))
        largest = np.abs(values[0]).max()
        if found.status[0] == Status.OK:
            loaded += 1
            assert abs(found.value[0, 0]) >= largest * (1 - 1e-5) - 1e-9, (seed, program, k)
    assert loaded
