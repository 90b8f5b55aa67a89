"""What a random mechanism's evaluation is worth: right by the oracle, refused
in words, or neither.
"""

from __future__ import annotations

import math
import traceback
import warnings
from dataclasses import dataclass, field

import numpy as np
from random_comparison import Comparison
from random_mechanisms import Drawn
from random_path import NEAR

from lagrange_casadi import evaluate, refine
from lagrange_casadi.errors import CertificateWarning, LagrangeCasadiError
from lagrange_casadi.peaks import forces


@dataclass
class Verdict:
    """``kind`` is right, refused, wrong, or broken (an exception that is not ours); ``why`` says it
    in a line.

    ``regular`` tells of the whole motion that its loops close far from any dead centre, so that a
    refusal wants a reason. ``notes`` are doubts about a right result: condemned by its certificate,
    unique forces withheld.
    """

    seed: int
    kind: str
    why: str
    regular: bool
    notes: list[str] = field(default_factory=list)
    details: list[str] = field(default_factory=list)


def judge(drawn: Drawn, *, peaks: bool = False, **method) -> Verdict:
    """Evaluate a random mechanism, and compare with the oracle; its ``peaks`` between instants
    too.
    """
    said, scene = {"seed": drawn.seed, "regular": is_regular(drawn)}, drawn.scene()
    try:
        with warnings.catch_warnings():
            warnings.simplefilter(
                "ignore", CertificateWarning
            )  # what the certificate says is among the notes
            solution = evaluate(scene, **drawn.keywords, **method)
            peaks = peaks and drawn.grid[2] > 1 and "wanted" not in drawn.keywords
            found = refine(scene, solution, forces(solution)) if peaks else []
    except LagrangeCasadiError as error:
        return Verdict(kind="refused", why=f"{type(error).__name__}: {error}", **said)
    except Exception as error:  # whatever it is, it is not ours
        return Verdict(
            kind="broken",
            why=f"{type(error).__name__}: {error}",
            details=[traceback.format_exc()],
            **said,
        )
    return compare(drawn, solution, found)


def is_regular(drawn: Drawn) -> bool:
    """Whether nothing stands against a result: all was told, the drives fit, and no dead centre is
    near.
    """
    path = drawn.path
    return (
        drawn.told
        and drawn.draft.fits
        and drawn.draft.holds
        and path.end >= drawn.grid[1]
        and path.steadiness > NEAR
        and path.passes == math.inf
    )


def compare(drawn: Drawn, solution, peaks=()) -> Verdict:
    """A solution beside the oracle, and its peaks between instants."""
    said = {"seed": drawn.seed, "regular": is_regular(drawn)}
    if not drawn.draft.fits:
        return Verdict(
            kind="wrong", why="there is a result, but the drives do not fit the freedoms", **said
        )
    found = Comparison(drawn, solution)
    found.look(peaks)
    kind = "wrong" if found.faults else "right"
    why = (found.faults or [""])[0]
    return Verdict(kind=kind, why=why, notes=found.notes, details=found.faults, **said)


def peaks_off(scene, solution, dense, names) -> list[str]:
    """Peaks between instants that are not those of many instants: less, or much more.

    A step with an end at rest is not searched for a quantity that rest leaves open.
    """
    step = np.searchsorted(solution.t[1:-1], dense.t, side="right")
    searched = dense.during(~(solution.resting[step] | solution.resting[step + 1]))
    largest = {
        unit: max(abs(dense.peak(name).value) for name in names if dense.unit(name) == unit)
        for unit in map(dense.unit, names)
    }
    off = []
    for peak in refine(scene, solution, names):
        size, many = largest[peak.unit], abs(dense.peak(peak.name).value)
        is_open = np.isnan(solution.array(peak.name)).any()
        least = abs(searched.peak(peak.name).value) if is_open else many
        if not least - 1e-9 * size <= abs(peak.value) <= many * 1.01 + 1e-2 * size:
            off.append(f"{peak}, {many} at one of many instants")
    return off
