"""Independent checks of a solution, from its own arrays and from what was declared: none shares the
graphs that made them.

The reported motions of the joints place every body anew, in plain arithmetic (:mod:`.placing`). The
reported reactions, efforts, loads and multipliers must then balance every body (Newton-Euler), the
power of drives and loads must be the change of kinetic energy, loops must close and the users'
equations hold, and the sections at a link's base must give back what its joints do there. Vectors
of a mechanism of the plane have what is in the plane. Each residual is relative, (t,).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from ...base.arrays import Array
from ...base.quantities import Output
from ...errors import CertificateError
from ...model.description import Description
from ...model.scene import kinds
from ...model.stated import NOTHING, Stated
from ..histories import Histories
from ..solution import Solution
from .balance import balance, forces_reported
from .closure import Residuals, closure
from .friction_laws import friction_residuals
from .placing import Placed, place
from .reported import COARSE, TOLERANCE, Reported, blur, precision_of
from .unplaced import place_all

NEAR = 1e3
_BLOCK = 1 << 13
_TURNED, _MISSED = 100.0, 100.0

_EDGE = 1e-9
"""Distance from a link's base, relative to its length, that counts as at the base."""


def certify(
    histories: Histories,
    stated: Stated = NOTHING,
    hidden: Mapping[Output, Array] | None = None,
    phases: Mapping[Output, Array] | None = None,
) -> dict[str, Array]:
    """The residuals that the solution's outputs allow: ``balance``, ``power``, ``closure``,
    ``ends``, ``friction``, each where it can be had; where a joint that rubs is at rest,
    ``closure``, and ``friction`` of others.

    ``stated`` are constraints, rows, motions and laws of loads, which a solution does not hold:
    without them, a solution of a mechanism that has constraints is looked at for ``closure`` alone.
    ``hidden`` are forces that it does not give: multipliers that were not wanted, and what is open,
    which takes some value all the same. ``phases`` are angles that are known up to whole turns more
    closely than they are reported.
    """
    resting = histories.resting
    if resting.any() and not resting.all():
        merged: dict[str, Array] = {}
        for some in (~resting, resting):
            pick = (
                {output: values[some] for output, values in (more or {}).items()}
                for more in (hidden, phases)
            )
            for name, distances in certify(histories.during(some), stated, *pick).items():
                merged.setdefault(name, np.zeros_like(histories.t))[some] = distances
        return merged
    whole = replace(histories, outputs={**histories.outputs, **(hidden or {})}, indeterminate=())
    reported = reported_of(whole, phases or {})
    starts = range(0, whole.t.size, _BLOCK)
    blocks = (
        (reported.during(slice(start, start + _BLOCK)) for start in starts)
        if len(starts) > 1
        else [reported]
    )
    found = [_residuals(histories.description, stated, block) for block in blocks]
    residuals: dict[str, Array] = {}
    for name in (name for name in found[0] if all(name in one for one in found)):
        relative = []
        for part in zip(*(of_block[name] for of_block in found), strict=True):
            gaps, scales = zip(*part, strict=True)
            relative.append(np.concatenate(gaps) / (max(0.0, *scales) or 1.0))
        residuals[name] = np.maximum.reduce(relative)
    return residuals


def tolerance(histories: Histories) -> float:
    """Limit of residuals: of loops that miss within the rounding of axes a multiple of how much."""
    exact = histories.provenance.precision == "double" and not any(
        word in histories.provenance.method for word in ("--newton", "--table")
    )
    missed = max(histories.description.missed.values(), default=0.0)
    limit = max(TOLERANCE, _TURNED * blur(histories), _MISSED * missed)
    return min(COARSE, limit) if exact else COARSE


def failure(solution: Solution) -> str:
    """Describe the residuals of a solution that fail."""
    worse = ", ".join(
        f"{_SAID.get(name, name)} {value:.2g}" for name, value in solution.failed.items()
    )
    return f"the certificate fails: {worse}, but at most {solution.tolerance:.2g} is rounding"


def refuse_failed(solution: Solution, then: str = "") -> None:
    """Raise :class:`.CertificateError` for a solution whose certificate fails, which says ``then``
    what became of it.
    """
    if solution.failed:
        raise CertificateError(failure(solution) + (f"; {then}" if then else ""))


def certified_outputs(outputs: Sequence[str]) -> list[str]:
    """The outputs that a certificate needs, by their kinds, of those that a scene has."""
    return ["effort", "motion", *(kind for kind in kinds(outputs) if kind in _ACTING)]


_ACTING = ("reaction", "multiplier", "load", "friction")
_SAID = {"ends": "section ends"}
_NOTHING = "not computed; it needs motion, efforts, reactions and loads"


def summary(residuals: Mapping[str, Array]) -> str:
    """The largest residuals, in one line; and how singular the loops are, where it matters."""
    parts = [
        f"{_SAID.get(name, name)} {np.max(values):.1e}"
        for name, values in residuals.items()
        if name != "condition"
    ]
    found = ", ".join(parts)
    said = f"certificate: {f'relative residuals {found}' if found else _NOTHING}"
    worst = float(np.max(residuals.get("condition", np.ones(1))))
    return said + (
        f"; near a dead centre, where the loops magnify errors by {worst:.3g}"
        if worst > NEAR
        else ""
    )


def reported_of(histories: Histories, phases: Mapping[Output, Array]) -> Reported:
    """Read a solution as vectors; ``phases`` as in :func:`certify`."""
    description = histories.description
    laws = {link: histories.section(link).law for link in histories.links_with_sections}
    return Reported(
        t=histories.t,
        outputs=histories.outputs,
        phases=phases,
        # What slides over the base of a link just now counts as at the base.
        laws={link: replace(law, slack=max(_EDGE, law.slack)) for link, law in laws.items()},
        lines="xyz" if description.space else "xy",
        turns="xyz" if description.space else "z",
        unmeasured=frozenset(description.unmeasured),
        precision=precision_of(histories),
    )


def placed_of(declared: Description, stated: Stated, reported: Reported) -> Placed | None:
    """Place every body by the reported motions; None where some is not reported."""
    needed = {Output("motion", name) for name in {*declared.coordinates} - reported.unmeasured}
    needed |= {Output("pose", name, "x") for name in declared.bodies}
    if not needed <= {*reported.outputs}:
        return None
    placed = place_all(place(declared, stated, reported.without_locked(declared)))
    return placed if len(placed.bodies) == len(declared.bodies) + 1 else None


def _residuals(
    declared: Description, stated: Stated, reported: Reported
) -> dict[str, list[Residuals]]:
    """The gaps of each residual, each with the largest of what it is to be compared with."""
    if (placed := placed_of(declared, stated, reported)) is None:
        return {}
    found = {"closure": closure(placed)}
    if (residuals := friction_residuals(placed)) is not None:
        found["friction"] = [(residuals, 1.0)]
    return found | (balance(placed) if forces_reported(placed) else {})
