"""``lagrange-casadi check``: the faults of a file."""

from __future__ import annotations

import subprocess
from collections.abc import Callable
from pathlib import Path

from ..base.apart import LostError, run_apart
from ..errors import StoreError
from ..results.store import runs as store
from ..results.store.opening import IDENTIFICATION, SEARCH, SWEEP, check_identification, kind_of
from ..results.store.untrusted import structured
from ..studies.optimise.search_file import check_optimum
from ..studies.sweep.checking import check_sweep, flaws, progress, unfinished
from .echo import echo
from .options import refuse

_VARIABLES = {"HDF5_PLUGIN_PRELOAD": "::"}
"""Environment by which HDF5 loads no filters from outside."""

_CHECKS: dict[str | None, Callable[[Path], list[str]]] = {
    SWEEP: check_sweep,
    SEARCH: check_optimum,
    IDENTIFICATION: check_identification,
}
"""Checks of files of each kind, but for those of runs."""

_LONGEST = 1e6
_LINES, _LENGTH = 100, 1000
"""Findings that are reported at most, and characters of each."""


def check(
    file: Path,
    *,
    untrusted: bool = False,
    time_limit: float | None = None,
) -> int:
    """Check that FILE.h5 is whole and consistent.

    The exit status is 0 if it is, else 1.

    Parameters
    ----------
    file : FILE.h5|FILE.h5.parts
    untrusted
        Read the file in a process of its own: forged files may crash or stall HDF5.
    time_limit : SECONDS
        Limit the time of --untrusted [s]; default: 60.
    """
    seconds = 60.0 if time_limit is None else time_limit
    refuse(
        (time_limit is not None and not untrusted, "--time-limit goes with --untrusted"),
        (
            not 0.0 < seconds <= _LONGEST,
            f"--time-limit: expected seconds above 0, up to {_LONGEST:g}, got {seconds:g}",
        ),
    )
    findings = _findings_apart(file, seconds) if untrusted else _findings(file)
    echo(*(f"{file}: {finding}" for finding in findings), err=True)
    if not findings:
        echo(f"{file}: whole and consistent")
    return 1 if findings else 0


def _findings(file: Path) -> list[str]:
    folder = unfinished(file)
    if folder:
        return [progress(folder), *flaws(folder)]
    return _CHECKS.get(kind_of(file), store.check)(file)


def _findings_apart(file: Path, seconds: float) -> list[str]:
    """Check a file in another process.

    Raises :class:`StoreError` where it does not end in time, or ends without an answer.
    """
    try:
        found: list[str] = run_apart(found_in, str(file), seconds=seconds, variables=_VARIABLES)
        structured(tuple[str, ...], found, "answer")
    except subprocess.TimeoutExpired:
        raise StoreError(
            f"{file}: was not read within {seconds:g} s, so it is large or forged; --time-limit"
            " sets another limit"
        ) from None
    except (LostError, ValueError) as error:
        raise StoreError(f"{file}: {error}") from None
    return found


def found_in(file: str) -> list[str]:
    """Return the first findings of a file, in few words."""
    found = _findings(Path(file))
    more = [f"and {len(found) - _LINES} more"] if len(found) > _LINES else []
    return [line[:_LENGTH] for line in found[:_LINES]] + more
