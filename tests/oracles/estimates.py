"""How estimates of errors compare with the errors, which fifty digits tell.

``python tests estimates`` prints the table of the cases, ``python tests estimates SCENES``
that of so many random scenes of every kind.
"""

from __future__ import annotations

import argparse

import numpy as np
from arithmetic import DTYPES, ROUNDING
from conftest import CASES, PLANAR
from internals import Output
from random_mechanisms import KINDS, draw
from truth import true_errors, truth

from lagrange_casadi import derive, evaluate, load_case
from lagrange_casadi.errors import LagrangeCasadiError

LEAST, FACTOR, MOST = 0.99, 10.0, 0.8
"""The least estimate over the error, and the share of those that are less than a factor more."""

METHODS = {
    "lanes": {"backend": "lanes"},
    "c": {"backend": "c"},
    "single": {"backend": "c", "precision": "single"},
    "newton 1": {"backend": "c", "newton": 1},
    "newton 2": {"backend": "c", "newton": 2},
    "newton 3": {"backend": "c", "newton": 3},
}
OPTIONS = {
    "lanes": "--backend lanes",
    "c": "--backend c",
    "single": "--backend c --precision single",
}

COUNT = 101
"""Instants of a grid."""


def kind(name):
    """What is measured by one peak: motions alone, else all of a group that
    have a unit in common.
    """
    group, *_ = name.split(":")
    return name if group.startswith(("motion", "_")) else (group, Output.of(name).quantity.unit)


def ratios(solution, exact):
    """Estimate over true error by quantity, where there is an error; what has none is estimated to
    have none to speak of.
    """
    true = true_errors(solution, exact)
    assert all(name.startswith("section:") for name in {*solution.errors} ^ {*true})
    precision = "single" if solution.provenance.precision == "single" else "double"
    unit, least = ROUNDING[precision], float(np.finfo(DTYPES[precision]).tiny)
    size, units = {}, {}
    for name, values in solution.series.items():
        peak = float(np.max(np.abs(values)))
        size[kind(name)] = max(size.get(kind(name), 0.0), peak)
        units.setdefault(solution.unit(name), []).append(peak)
    found = {}
    for name, error in true.items():
        scale = max(
            size.get(kind(name), 0.0),
            0.0 if name in solution.series else abs(solution.peak(name).value),
        )
        if error > unit**2 * scale:
            found[name] = solution.errors[name] / error
        else:
            # What vanishes is as uncertain as the last digit of the largest of its unit.
            scale = max(scale, *units.get(solution.unit(name), [0.0]))
            assert solution.errors[name] <= 100 * unit * scale + least, name
    return found


def assert_near(found):
    """Most estimates within a factor of ten, none below the error."""
    worst = min(found, key=lambda name: found[name])
    assert found[worst] > LEAST, (worst, found[worst])
    assert np.mean([value < FACTOR for value in found.values()]) >= MOST


def methods(scene):
    """The evaluation methods of a scene, steps of Newton's method where its loops are iterated."""
    closed = derive(scene).newton is None
    return {
        method: words for method, words in METHODS.items() if not (closed and "newton" in words)
    }


def looked_at(scene, several, **given):
    """Estimates over true errors of a scene, by quantity, for each of several methods; none where
    it is refused: steps may be too few for any solution.
    """
    exact = None
    for words in several:
        try:
            solution = evaluate(scene, **words, **given)
        except LagrangeCasadiError:
            continue
        exact = exact or truth(scene, solution.t, given.get("parameters"))
        yield ratios(solution, exact)


def random(kind, seed):
    """A random scene of a kind, and what it is evaluated with."""
    drawn = draw(seed, kind)
    start, stop, count = drawn.grid
    given = {"t": (start, stop, min(count, 21)), "parameters": drawn.keywords.get("parameters")}
    return drawn.scene(), given


def row(name, found):
    """A row of a table."""
    parts = [np.min(found), *np.quantile(found, (0.05, 0.5, 0.95))]
    near = np.mean([1 / FACTOR < value < FACTOR for value in found])
    return (
        f"| {name} | {len(found)} | {' | '.join(f'{part:.2g}' for part in parts)} |"
        f" {100 * near:.3g} % |"
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "scenes", nargs="?", type=int, help="random scenes of every kind, in place of the cases"
    )
    parser.add_argument(
        "--method", choices=METHODS, action="append", help="only these; default: all"
    )
    told = parser.parse_args()
    print(
        f"| {'kind, method' if told.scenes else 'method'} | quantities | least | 5 % | median | 95"
        " % | within a factor of ten |"
    )
    print("| --- | --- | --- | --- | --- | --- | --- |")
    groups = {"": [(load_case(CASES / name).scene, {}) for name in PLANAR]}
    if told.scenes:
        groups = {kind: [random(kind, seed) for seed in range(told.scenes)] for kind in KINDS}
    for method in told.method or METHODS:
        option, every = f"`{OPTIONS.get(method, f'--{method}')}`", []
        for kind, many in groups.items():
            found = [
                value
                for scene, given in many
                for one in looked_at(scene, [METHODS[method]] * (method in methods(scene)), **given)
                for value in one.values()
            ]
            every += found
            if kind:
                print(row(f"{kind.replace('_', ' ')}, {option}", found), flush=True)
        print(row(option if not told.scenes else f"all, {option}", every), flush=True)


if __name__ == "__main__":
    main()
