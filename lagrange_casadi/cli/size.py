"""``lagrange-casadi size``: the lightest profile for each link that is safe."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path
from typing import Any

from ..base.vocabulary import Criterion, Yielding
from ..model.beams.profiles import read_profiles
from ..studies.case import load_case
from ..studies.sizing import Sized
from ..studies.sizing import size as choose
from .echo import echo
from .options import refuse
from .strength_lines import evaluated, safety_lines


def size(
    case: Path,
    *,
    profiles: Path | None = None,
    safety: float = 2.0,
    deflection: float | None = None,
    links: Sequence[str] = (),
    criterion: Criterion = "goodman",
    yield_criterion: Yielding = "von_mises",
    **given: Any,
) -> None:
    """Choose the lightest safe profile for each link of CASE.

    The loads follow the masses of the chosen profiles.

    Parameters
    ----------
    case : CASE
    profiles : FILE.csv|NAME
        Choose from this table: a column name, and one column per dimension [m]; or by name from a
        standard one: IPE, HEA, HEB, CHS, SHS, RHS, SHS_cold, RHS_cold, flat, round. Default:
        profiles.csv next to the case.
    safety : FACTOR
        As of :func:`.studies.sizing.size`.
    deflection : SHARE
        As of :func:`.studies.sizing.size`.
    links : LINK
        As of :func:`.studies.sizing.size`.
    criterion, yield_criterion, parameters, t, over
        As of :func:`.studies.sizing.size`.
    """
    loaded = load_case(case)
    beside = loaded.path.parent / "profiles.csv"
    refuse(
        (
            profiles is None and not beside.is_file(),
            f"--profiles: expected a table of profiles; the folder of the case has none, {beside}",
        )
    )
    table = read_profiles(profiles or beside)
    found = choose(
        loaded.scene,
        table,
        safety=safety,
        links=links or None,
        deflection=deflection,
        criterion=criterion,
        yield_criterion=yield_criterion,
        **given,
    )
    stiff = (
        "" if deflection is None else f", and a deflection of at most {deflection:g} of its length"
    )
    solution = found.solution
    echo(
        f"{solution.case}: the lightest of {len(table)} profiles with a factor of safety of at"
        f" least {safety:g}{stiff}:"
    )
    for sized in found.links:
        echo(*_lines(sized))
    safety_of = partial(solution.safety, criterion=criterion, yield_criterion=yield_criterion)
    for name, why in found.left.items():
        shown = evaluated(name, lambda link: safety_lines(safety_of(link)))
        echo(f"{name}: not sized: {why}", *shown)
    verdict = "holds" if solution.certified else "fails" if solution.failed else "not computed"
    echo(
        (
            f"together {found.mass:.6g} kg; {found.evaluations} evaluations of the loads;"
            f" certificate: {verdict}"
        ),
        " ".join(f"--set {name}={value!r}" for name, value in found.parameters.items()),
    )


def _lines(sized: Sized) -> Iterator[str]:
    """A link with what was chosen for it, what governs, and why nothing lighter will do."""
    yield f"{sized.link}: '{sized.profile.name}', {sized.mass:.6g} kg"
    yield from safety_lines(sized.safety)
    if sized.lighter is not None:
        profile, found = sized.lighter
        yield (
            f"    lighter: '{profile.name}' has a factor of {found.factor:.4g} against"
            f" {found.governs.against}"
        )
