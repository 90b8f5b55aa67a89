"""How far a solution really is off: its outputs against the scene's graphs in fifty digits, on the
side of a jump that it took.
"""

from __future__ import annotations

import functools
import itertools
from dataclasses import dataclass, replace

import casadi as ca
import mpmath
import numpy as np
from internals import EvaluationMethod, reference, run
from oracle import SECTION

from lagrange_casadi import derive

MP, DIGITS = mpmath.mp, 50
RATIOS = (0.0, 0.31, 0.64, 1.0)
NEAR = 1e-3
"""How near to a jump a result may be on its other side, of the largest of what is compared."""

MOST = 4
"""Of so many jumps that are near at an instant every choice of sides is tried, of more the first
ones'.
"""


@dataclass(frozen=True, eq=False)
class Truth:
    """What a scene has at some instants: for each the columns by name, and those on the other side
    of every jump that is near.
    """

    mechanism: object
    values: dict
    sides: list


@MP.workdps(DIGITS)
def truth(scene, t, parameters=None):
    """What a scene has at instants ``t``, one after the other in time, of loops that are closed:
    numbers of fifty digits.
    """
    values = scene.mechanism.values(parameters)
    program, p = derive(scene), list(values.values())
    z = None
    if program.newton is not None:
        grid = np.unique([*np.linspace(*scene.span, 200), *t])
        z = run(program, grid, np.array(p), EvaluationMethod("vm"))[0].iterated[
            :, np.searchsorted(grid, t)
        ]
    decisions = [[] for _ in t]
    rest = iter(decisions)
    rows = reference(
        program, t, p, z=z, following=lambda arithmetic: _listening(arithmetic, next(rest))
    )
    sides = []
    for i, (row, others) in enumerate(zip(rows, _others(decisions), strict=True)):
        found = [row]
        for taken in others:
            at = None if z is None else z[:, i : i + 1]
            found += reference(
                program,
                t[i : i + 1],
                p,
                z=at,
                following=lambda arithmetic, taken=taken: _taking(arithmetic, taken),
            )
        sides.append([dict(zip(program.names, one, strict=True)) for one in found])
    return Truth(scene.mechanism, values, sides)


@MP.workdps(DIGITS)
def true_errors(solution, exact, sections=True):
    """The largest error of every output over the instants, by full name; angles up to whole turns.

    A section force is looked at at :data:`RATIOS` and on both sides of stations, where each station
    is seen as in the solution; that of a link along which a load is spread is not.
    """
    names = [
        name for name in exact.sides[0][0] if name in solution.series and solution.determined(name)
    ]
    angles = {name for name in names if _is_angle(solution, name)}
    size = {name: float(np.max(np.abs(solution.series[name]))) or 1.0 for name in names}
    gaps = {}
    spread = {name.split(":")[1] for name in solution.series if ":q" in name or ":c0" in name}
    links = [link for link in solution.links_with_sections if sections and link not in spread]
    looked = {link: _looked_at(solution.section(link).law) for link in links}
    matter = {link: matter_of(exact.mechanism, exact.values, link) for link in looked}
    for i, sides in enumerate(exact.sides):
        found = [
            {name: _gap(row[name], solution.series[name][i], name in angles) for name in names}
            for row in sides
        ]
        best = min(
            range(len(sides)),
            key=lambda k: max((found[k][name] / size[name] for name in names), default=0.0),
        )
        for name, gap in found[best].items():
            gaps.setdefault(name, []).append(gap)
        for link, found in looked.items():
            for force, gap in _section_gaps(matter[link], found, i, sides[best], link):
                if solution.determined(f"section:{link}:{force}"):
                    gaps.setdefault(f"section:{link}:{force}", []).append(gap)
    return {name: max(found) for name, found in gaps.items()}


def section(columns, matter, link, ratio, seen=None):
    """Axial, shear and bending of a link at a ratio, from its law and stations, by the moments as
    they are defined.

    ``matter`` is the link's :func:`matter_of`. ``seen`` says of each station whether the section
    sees it, by default where it lies between the section and the tip.
    """
    (l, beyond), u = matter, MP.mpf(ratio)
    mu, xi = beyond(u), u * l
    n0, n1, n2, f0, f1, f2, m0 = (
        columns[f"section:{link}:law:{k}"] for k in ("n0", "n1", "n2", "f0", "f1", "f2", "m0")
    )
    axial, shear = n0 + n1 * mu[0] + n2 * mu[1], f0 + f1 * mu[0] + f2 * mu[1]
    bending = m0 + f0 * (l - xi) + f1 * (mu[1] - xi * mu[0]) + f2 * (mu[2] - xi * mu[1])
    for name in columns:
        if name.startswith(f"section:{link}:") and name.endswith(":station"):
            n, f, m, station = (
                columns[name.removesuffix("station") + member]
                for member in ("n", "f", "m", "station")
            )
            there = sees(u, station) if seen is None else seen[name.split(":")[2]]
            if there:
                axial, shear, bending = axial + n, shear + f, bending + m + f * (station - u) * l
    return axial, shear, bending


def sees(u, station, side="tip", slack=1e-12):
    """Whether a section at a ratio feels what acts at a station; what misses an end by less than
    ``slack`` acts there.
    """
    near = min(max(u, slack), 1 - slack)
    return near < station or (side == "base" and near == station)


def matter_of(mechanism, values, link):
    """A link's :func:`matter` for values of the parameters."""
    body = mechanism.links[link]
    cells = [[mechanism.number(x, values) for x in cell] for cell in body.mass.cells]
    return matter(body.mass, mechanism.number(body.length, values), cells)


def matter(density, length, cells):
    """A link's length, and as a function of a ratio the moments of what lies beyond it, about the
    base; ``cells`` are the density's coefficients as numbers.
    """
    l = MP.mpf(length)
    size = l if density.per_length else 1
    cells = [[MP.mpf(coefficient) * size for coefficient in cell] for cell in cells]

    @functools.cache
    def beyond(u):
        mu = [MP.mpf(0)] * 3
        for (a, b), cell in zip(
            itertools.pairwise(map(MP.mpf, density.breaks)), cells, strict=True
        ):
            for (j, coefficient), k in itertools.product(enumerate(cell), range(3)):
                mu[k] += (
                    coefficient
                    * l**k
                    * max(b ** (j + k + 1) - max(a, u) ** (j + k + 1), 0)
                    / (j + k + 1)
                )
        return mu

    return l, beyond


def _looked_at(law):
    """A law's stations by name, the ratios to look at, (t, n), and the forces there by side, each
    (t, n).
    """
    stations = {load.name: load.station for load in law.loads}
    ratios = np.tile(RATIOS, (law.coefficients["n0"].size, 1))
    ratios = np.column_stack(
        [ratios, *(np.clip(station, 0.0, 1.0) for station in stations.values())]
    )
    forces = {
        side: [law.at(force, ratios, side) for force in SECTION]
        for side in (("tip", "base") if stations else ("tip",))
    }
    return stations, ratios, forces, law.slack


def _section_gaps(matter, looked, i, columns, link):
    stations, ratios, forces, slack = looked
    for (k, u), (side, mine) in itertools.product(enumerate(ratios[i]), forces.items()):
        there = ((name, float(station[i])) for name, station in stations.items())
        seen = {name: sees(u, station, side, slack) for name, station in there}
        true = section(columns, matter, link, u, seen)
        for force, value, own in zip(SECTION, true, mine, strict=True):
            yield force, float(abs(value - MP.mpf(float(own[i, k]))))


def _is_angle(solution, name):
    return name.endswith(":angle") or (name.startswith("motion:") and solution.unit(name) == "rad")


def _gap(true, mine, angle):
    gap = true - MP.mpf(float(mine))
    return abs(float(gap - 2 * MP.pi * MP.nint(gap / (2 * MP.pi)) if angle else gap))


STEPS = {
    **dict.fromkeys((ca.OP_LT, ca.OP_LE, ca.OP_EQ, ca.OP_NE), lambda *_: 1),
    **dict.fromkeys((ca.OP_FLOOR, ca.OP_CEIL, ca.OP_SIGN), lambda *_: 1),
    **dict.fromkeys((ca.OP_FMOD, ca.OP_REMAINDER), lambda x, period: abs(period)),
    ca.OP_ATAN2: lambda *_: 2 * MP.pi,
    ca.OP_COPYSIGN: lambda x, sign: 2 * abs(x),
}
"""Operations that jump, and of what their jumps are multiples."""


def _numbered(arithmetic, apply):
    """An arithmetic whose operations are handed on with their number and code."""
    count = itertools.count()

    def rule(code, operation):
        return lambda *values: apply(next(count), code, operation, values)

    return replace(
        arithmetic,
        operations={
            code: rule(code, operation) for code, operation in arithmetic.operations.items()
        },
    )


def _listening(arithmetic, decisions):
    """What may jump is noted: number, code, operation, operands."""

    def apply(k, code, operation, values):
        if code in STEPS:
            decisions.append((k, code, operation, values))
        return operation(*values)

    return _numbered(arithmetic, apply)


def _taking(arithmetic, taken):
    """Results by number in place of what an operation gives."""
    return _numbered(
        arithmetic,
        lambda k, code, operation, values: taken[k] if k in taken else operation(*values),
    )


def _others(decisions):
    """For every instant the ways in which decisions that are near a jump there may be taken
    otherwise.
    """
    sizes = {}
    for at_instant in decisions:
        for k, code, _, values in at_instant:
            compared = values[1:] if code == ca.OP_COPYSIGN else values
            sizes[k] = max(sizes.get(k, MP.mpf(0)), *map(abs, compared))
    for at_instant in decisions:
        near = [
            (k, found)
            for k, *decision in at_instant
            if (found := _otherwise(*decision, NEAR * sizes[k]))
        ][:MOST]
        choices = itertools.product(
            *([(k, None), *((k, result) for result in found)] for k, found in near)
        )
        yield [
            taken
            for choice in choices
            if (taken := {k: result for k, result in choice if result is not None})
        ]


def _otherwise(code, operation, values, near):
    """The results of an operation beyond a jump, where that is near."""
    result, step, k = operation(*values), STEPS[code](*values), int(code == ca.OP_COPYSIGN)
    found = set()
    for moved in (values[k] - near, values[k] + near):
        there = operation(*values[:k], moved, *values[k + 1 :])
        found.add(result + step * MP.nint((there - result) / step) if step else result)
    return found - {result}
