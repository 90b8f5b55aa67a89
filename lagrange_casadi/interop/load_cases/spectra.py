"""Load spectra: rainflow matrices of what loads a part."""

from __future__ import annotations

import math
import os
from pathlib import Path

import numpy as np

from ...base.arguments import Index, public
from ...base.arrays import Array
from ...base.files import writing
from ...base.table_writers import csv_text
from ...errors import DeclarationError, check_known
from ...results.solution import Solution
from ...results.strength.rainflow import counted

_HEADS = ("range", "mean", "cycles", "range_low", "range_high", "mean_low", "mean_high")


@public
def write_spectrum(
    solution: Solution,
    name: str,
    path: str | os.PathLike[str],
    *,
    classes: Index = 64,
    repeating: bool = True,
) -> None:
    """Write the rainflow matrix of a quantity as CSV: ranges, means and counts of its cycles.

    Parameters
    ----------
    solution
        A solution.
    name
        What ``solution.array`` takes, as ``reaction:A:fx``; at a ratio xi/l of a link a section
        force, as ``section:rod:bending@0.5``, or the normal stress of the fibre where its range is
        widest, ``stress:rod@0.5``.
    path
        The file. Rows with their classes begin with ``range``, ``mean`` and ``cycles``.
    classes
        Classes of ranges and of means; 0 writes each cycle with its range and mean as they are.
    repeating
        True if the history repeats for ever, so that its ends are no cycle by themselves.

    Raises
    ------
    DeclarationError
        For a quantity that was not evaluated, or is indeterminate.
    PathError
        If the file cannot be written.
    """
    history, unit = _history(solution, name)
    if history.ndim != 1:
        raise DeclarationError(f"spectrum of '{name}': give a ratio too, as in '{name}@0.5'")
    if not np.isfinite(history).all():
        raise DeclarationError(f"spectrum of '{name}': it is indeterminate at some instants")
    cycles = [one[:3] for one in counted(history, repeating=repeating) if one.size > 0.0]
    size, mean, times = np.array(cycles).reshape(-1, 3).T
    if classes:
        lowest, widest = float(history.min()), float(np.ptp(history))
        ranges, means = (np.linspace(x, x + widest, classes + 1) for x in (0.0, lowest))
        found, _, _ = np.histogram2d(size, mean, bins=(ranges, means), weights=times)
        i, j = np.nonzero(found)
        ends = ranges[i], ranges[i + 1], means[j], means[j + 1]
        rows = [(ends[0] + ends[1]) / 2, (ends[2] + ends[3]) / 2, found[i, j], *ends]
    else:
        (size, mean), same = np.unique([size, mean], axis=1, return_inverse=True)
        rows = [size, mean, np.bincount(same.ravel(), times), size, size, mean, mean]
    seconds, again = np.ptp(solution.t), "which repeat" if repeating else "once"
    head = f"# {name} [{unit}], counted over {seconds:.9g} s, {again}\n"
    with writing(Path(path)) as draft:
        draft.write((head + csv_text([_HEADS, *np.column_stack(rows).tolist()])).encode())


def _history(solution: Solution, name: str) -> tuple[Array, str]:
    """Return a quantity over time, and its unit."""
    group, _, rest = name.partition(":")
    quantity, at, place = rest.partition("@")
    if not at:
        return solution.array(name), solution.unit(name)
    try:
        ratio = float(place)
    except ValueError:
        ratio = math.nan
    if not 0.0 <= ratio <= 1.0 or group not in ("section", "stress"):
        raise DeclarationError(
            f"spectrum of '{name}': expected section:LINK:FORCE@RATIO or stress:LINK@RATIO, with a"
            " ratio xi/l from 0 to 1"
        )
    if group == "stress":
        stresses = solution.stress(quantity).at(ratio)[0]
        return stresses[int(np.argmax(np.ptp(stresses, axis=1)))], "Pa"
    link, _, force = quantity.rpartition(":")
    law, forces = solution.section(link).law, solution.table.forces
    check_known("section force", [force], forces, place=f"spectrum of '{name}'")
    values = law.at(force, np.full((solution.t.size, 1), ratio))[:, 0]
    return np.asarray(values), solution.unit(f"section:{quantity}")
