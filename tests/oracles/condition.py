"""How exact a solution is, beside what its outputs mean and how much they change with its inputs:
the condition, which no algorithm can better.

What outputs mean is what :mod:`precise` finds, in 50 digits, with the law of motion itself and not
its doubles. An output's condition is the sum, over every number that goes in, of what it changes
for a change of that number by one part, over the output's peak: differences of the graph followed
in as many digits. Directions go in without their whole turns.
"""

from __future__ import annotations

import functools
import itertools
import math
from dataclasses import dataclass

import casadi as ca
import numpy as np
from arithmetic import DTYPES, ROUNDING
from balance import settle
from internals import arithmetic, interpret
from mpmath import mp
from oracle import SECTION
from precise import precise
from truth import matter, section

DIGITS = 50
LEAST = 1e-30
"""Pivots of the free bodies' equations below which there is none: no equation repeats another here,
but some nearly do.
"""

CHANGE = 20
"""Inputs change by ten to the minus so much."""

RATIOS = (0.0, 1e-12, 0.3, 0.7, 1.0 - 1e-12, 1.0)
BESIDE = {"double": 2e-12, "single": 2e-6}
"""How near load points the sections are looked at: twice as far as a load point that is at the
section.
"""


@dataclass(frozen=True)
class Place:
    """A quantity by its full name, and for a section force where: a ratio, and the precisions that
    can tell it from a station.
    """

    name: str
    ratio: object = None
    precisions: tuple[str, ...] = tuple(BESIDE)

    @property
    def peak(self):
        """What is measured by one peak: the members of a force or a place together, since which
        axis is which is arbitrary.
        """
        group, _, part = self.name.partition(":")
        part, _, member = (
            part.rpartition(":") if group in ("reaction", "section", "pose") else (part, "", "")
        )
        return (
            group,
            part,
            {"mz": "mz", "bending": "moment", "angle": "angle"}.get(member, "vector"),
        )


@dataclass(frozen=True)
class Instant:
    """What outputs mean at the i-th instant, and how much they change, by place: mpmath numbers."""

    i: int
    exact: dict
    changes: dict


def meaning(scene, program, i, t, values):
    """What the outputs of a graph mean at an instant.

    ``values`` are the parameters by name, doubles that are taken as exact.
    """
    with mp.workdps(DIGITS):
        time, p = mp.mpf(t), [mp.mpf(value) for value in values.values()]
        driven = interpret(program.motion, [[time], p], arithmetic())
        rough = [
            mp.mpf(float(x))
            for x in settle(program, t, list(values.values()), program.data.span[0]).full().ravel()
        ]
        z = closed(program, rough, time, driven, p)
        places, own = _outputs(scene, program, time, driven, z, p, None)
        total = [mp.mpf(0)] * len(own)
        step = mp.mpf(10) ** -CHANGE
        for changed, others in _changed(scene, program, driven, p, step):
            _, other = _outputs(
                scene,
                program,
                time,
                changed,
                closed(program, z, time, changed, others),
                others,
                places,
            )
            total = [
                change + abs(a - b) / step for change, a, b in zip(total, other, own, strict=True)
            ]
        drives = dict(zip(program.driven, zip(*driven, strict=True), strict=True))
        free = precise(scene, t, drives, values, least=LEAST)
        for joint in scene.mechanism.joints.values():
            if joint.kind == "revolute" and joint.coordinate:
                child, parent = (
                    free.get(f"pose:{point.body.name}:angle", 0)
                    for point in (joint.child, joint.parent)
                )
                free[f"motion:{joint.name}"] = child - parent
        zero = mp.mpf(10) ** (10 - DIGITS) * max(
            abs(value) for name, value in free.items() if name.startswith(("effort", "reaction"))
        )
        exact = {
            place: _found(free.get(place.name, value), place, zero)
            for place, value in zip(places, own, strict=True)
        }
        return Instant(i, exact, dict(zip(places, total, strict=True)))


def _found(value, place, zero):
    """What the free bodies have at a place, their last digits left out where a section force is
    zero.
    """
    found = mp.mpf(value(place.ratio) if callable(value) else value)
    return found if abs(found) > zero or not callable(value) else mp.mpf(0)


def _changed(scene, program, driven, p, step):
    """The inputs with one of them changed, one after the other: driven coordinates, rates and
    accelerations, and parameters.
    """
    joints = scene.mechanism.joints
    for order, row in enumerate(driven):
        for j, value in enumerate(row):
            if order == 0 and joints[program.driven[j]].coordinate == "angle":
                value -= 2 * mp.pi * mp.nint(value / (2 * mp.pi))
            yield (
                [
                    [x + step * value if (i, k) == (order, j) else x for k, x in enumerate(xs)]
                    for i, xs in enumerate(driven)
                ],
                p,
            )
    for k, value in enumerate(p):
        if value and _read(scene, program)[k]:
            yield driven, [x + step * value if i == k else x for i, x in enumerate(p)]


@functools.lru_cache(maxsize=32)
def _made(scene, program):
    """Length and density's coefficients of every link that has sections, one below the other, as a
    function of the parameters.
    """
    m = scene.mechanism
    made = [
        ca.SX(x)
        for name in program.wanted.sections
        for x in (m.links[name].length, *_coefficients(m.links[name]))
    ]
    return ca.Function("made", [m.symbols], [ca.densify(ca.vertcat(ca.SX(0, 1), *made))])


def _coefficients(link):
    return itertools.chain(*link.mass.cells)


def _matter(scene, program, p):
    """What each link is made of: see :func:`truth.matter`."""
    m, found = scene.mechanism, {}
    (numbers,) = interpret(_made(scene, program), [p], arithmetic())
    numbers = iter(numbers)
    for name in program.wanted.sections:
        density, length = m.links[name].mass, next(numbers)
        found[name] = matter(density, length, [[next(numbers) for _ in c] for c in density.cells])
    return found


@functools.lru_cache(maxsize=32)
def _read(scene, program):
    """Which parameters an instant reads, or a link's length or density: the law of motion's own are
    none of these.
    """
    slopes = (
        program.instant.jac_sparsity(0, program.instant.index_in("p")),
        _made(scene, program).jac_sparsity(0, 0),
    )
    read = {k for slope in slopes for k in slope.get_col()}
    return [k in read for k in range(program.instant.size1_in("p"))]


def closed(program, z, time, driven, p):
    """The iterated coordinates to all digits."""
    size = mp.mpf(program.newton is not None)
    while size > mp.mpf(10) ** (4 - DIGITS):
        correction, (size,) = interpret(
            program.newton.step, [z, [time], driven[0], p], arithmetic()
        )
        z = [a + b for a, b in zip(z, correction, strict=True)]
    return z


def _outputs(scene, program, time, driven, z, p, places):
    """Values at places, by default those that the outputs themselves suggest."""
    (found,) = interpret(program.instant, [[time], *driven, z, p], arithmetic())
    named = {
        name: value
        for name, value in zip(program.names, found, strict=True)
        if not name.startswith("_")
    }
    stations = {link: {} for link in program.wanted.sections}
    for name, value in named.items():
        if name.startswith("section:") and name.endswith(":station"):
            _, link, part, _ = name.split(":")
            stations[link][part] = value
    if places is None:
        places = [Place(name) for name in named if not name.startswith("section:")] + [
            Place(f"section:{link}:{force}", *where)
            for link, there in stations.items()
            for where in _ratios(there.values())
            for force in SECTION
        ]
    values, made = [], _matter(scene, program, p)
    for place in places:
        if place.ratio is None:
            values.append(named[place.name])
        elif place.name.endswith(SECTION[0]):
            # All three of a section at once: their places follow each other.
            link, u = place.name.split(":")[1], place.ratio
            seen = {part: u < at or u == 1 <= at for part, at in stations[link].items()}
            values += section(named, made[link], link, u, seen)
    return places, values


def _ratios(stations):
    """Ratios from base to tip, and beside every station."""
    yield from ((mp.mpf(ratio),) for ratio in RATIOS)
    for at in stations:
        for precisions, near in (
            (("double",), BESIDE["double"]),
            (("double", "single"), BESIDE["single"]),
        ):
            yield from ((mp.mpf(float(at + side * near)), precisions) for side in (-1, 1))


@dataclass(frozen=True)
class EvaluatedDesign:
    """An output's largest error over its peak, its largest condition, and its largest error in
    roundings times its condition.
    """

    name: str
    error: float
    condition: float
    units: float


def judged(solution, program, meant, peaks):
    """How far the outputs of a solution are from what they mean at some instants, worst first;
    ``peaks``: see :func:`peaks_of`.

    What is smaller than the smallest normal number of the precision is no error.
    """
    precision, found = solution.provenance.precision, {}
    with mp.workdps(DIGITS):
        for place, gap, change in _gaps(solution, program, meant):
            peak = peaks[place.peak]
            gap = max(gap - float(np.finfo(DTYPES[precision]).tiny), 0)
            # What is zero throughout must be zero.
            error, condition = (
                (float(gap / peak), max(float(change / peak), 1.0))
                if peak
                else (math.inf if gap else 0.0, 1.0)
            )
            found.setdefault(place.name, []).append(
                (error, condition, error / condition / ROUNDING[precision])
            )
    judges = [
        EvaluatedDesign(name, *map(max, zip(*rows, strict=True))) for name, rows in found.items()
    ]
    return sorted(judges, key=lambda judge: -judge.units)


def understated(solution, program, meant):
    """The outputs whose estimated error is less than a tenth of their true one, with both."""
    worst = {}
    for place, gap, _ in _gaps(solution, program, meant):
        worst[place.name] = max(worst.get(place.name, 0), gap)
    return {
        name: (solution.errors[name], float(gap))
        for name, gap in worst.items()
        if not 10 * solution.errors[name] >= gap
    }


def peaks_of(solution):
    """The largest value of everything that is measured by one peak: over the instants, and along a
    link.
    """
    squares = {}
    for name in solution.names():
        place = Place(name)
        if name.startswith("section:"):
            _, link, force = name.split(":")
            values = solution.section(link).law.at(
                force, np.tile([float(ratio) for ratio in RATIOS], (solution.t.size, 1))
            )
        else:
            values = solution.series[name]
        # Without squares, which underflow.
        squares.setdefault(place.peak, []).append(np.abs(values))
    return {
        peak: float(np.max(functools.reduce(np.hypot, values))) for peak, values in squares.items()
    }


def _gaps(solution, program, meant):
    for instant in meant:
        law = functools.lru_cache(maxsize=None)(
            lambda link, i=instant.i: solution.section(link).law.during(slice(i, i + 1))
        )
        for place, value in instant.exact.items():
            if solution.provenance.precision not in place.precisions:
                continue
            if place.ratio is None:
                mine = solution.series[place.name][instant.i]
            else:
                _, link, force = place.name.split(":")
                mine = law(link).at(force, np.array([[float(place.ratio)]]))[0, 0]
            with mp.workdps(DIGITS):
                gap = mp.mpf(float(mine)) - value
                if place.name in map(str, program.loop_angles):
                    gap -= 2 * mp.pi * mp.nint(gap / (2 * mp.pi))
            yield place, abs(gap), instant.changes[place]
