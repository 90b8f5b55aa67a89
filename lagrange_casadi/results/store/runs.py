"""A solution in an HDF5 file, and back: the schema is written down in ``docs/schema.md``.

A file is sealed, and appears whole: a reader finds the file of before, or the new one. What is read
is held to its seal before HDF5 sees it (:mod:`.opening`), and looked at before it is believed
(:mod:`.untrusted`).
"""

from __future__ import annotations

import math
import os
import shutil
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import h5py
import numpy as np

from ...base.arguments import public
from ...base.arrays import Array
from ...base.files import check_writable, is_hdf5, settled, writing
from ...base.interrupts import uninterrupted
from ...base.quantities import Output
from ...base.tables import ANGLE, LENGTH
from ...engine.instants.beyond_equilibrium import ENDS, Holding
from ...errors import PathError, StoreError, check_known, one_line
from ...model.description import Description
from ...model.even_points import are_even
from ...model.times import DriveAxis
from ...model.wanted_names import SENSITIVITY
from ..histories import Histories
from ..ordering import in_order
from ..solution import Solution
from ..verification.certificate import certify
from ..verification.reported import COARSE, TOLERANCE, blur
from .attributes import (
    attributes_to_write,
    check_attributes,
    figures_of,
    read_attributes,
)
from .dataset_words import place_of, unlike_conventions
from .datasets import AXES, OVER, Stored, datasets_of
from .kept_slopes import slopes_of
from .opening import KINDS, RUN, kind_of, opened_file, sealed
from .scales import Scales
from .untrusted import (
    check_links,
    number,
    numbers,
    parsed,
    reported_as,
    shown,
)

_OVER_TOLERANCE = {"double": 1e-12, "single": 1e-6}
"""Largest distance of a coordinate from that by which the instants were defined, relative to the
largest.
"""

_TABLES = (".csv", ".tsv", ".txt", ".xls", ".xlsx", ".json", ".mat", ".parquet")


@public
def save(
    solution: Solution,
    path: str | os.PathLike[str],
    figures: str = "",
    *,
    grids: bool | Sequence[str] | None = None,
) -> None:
    """Write a solution to a file; an existing file is replaced completely or not at all.

    Parameters
    ----------
    solution
        The solution.
    path
        The file, HDF5.
    figures
        Specifications of figures as JSON, which :mod:`.figures` reads from the file.
    grids
        Links whose section forces are stored at every ratio xi/l too, beside their laws: all or
        none, or those that are named; by default all but the pieces of bent bars. Nothing is lost
        without them: :func:`load` fills grids from the laws.

    Raises
    ------
    StoreError
        If the file cannot be written, or has attributes that :func:`load` or the command plot
        refuses.
    """
    target, links = Path(path), _with_grids(solution, grids)
    check_target(target)
    with reported_as("cannot be written", target):
        attributes = attributes_to_write(solution, figures, links)
    datasets = [*datasets_of(solution, links)]
    _require_space(datasets, target)
    with (
        writing(target, hdf5=True) as bytes_,
        uninterrupted() as breathe,
        sealed(bytes_, RUN) as file,
    ):
        try:
            scales = Scales(file)
            for dataset in datasets:
                dataset.write(file, scales, breathe)
            scales.finish()
            if solution.over:
                file.attrs["coordinates"] = OVER
            file.attrs.update(attributes)
        except RuntimeError as error:  # of HDF5
            raise StoreError(f"cannot write {target}: {one_line(error)}") from error


def check_target(target: Path, kind: str = RUN) -> None:
    """Raise :class:`PathError` where no file of a kind can be put: it replaces another one, and
    nothing else that holds anything.

    Nor may its name end as that of a table, which it is not.

    Raises :class:`BusyError` where another program writes what is there.
    """
    if target.suffix.lower() in _TABLES:
        name = target.with_suffix(".h5").name
        raise PathError(
            f"cannot write {target}: results are kept as HDF5, under a name such as {name}; for a"
            " table of a solution use solution.to_pandas().to_csv(...)"
        )
    check_writable(target, hdf5=True)
    place = settled(target)
    if not place.exists() or not place.stat().st_size:
        return
    found = kind_of(place)
    if found != kind:
        what = "no file of HDF5"
        if found or is_hdf5(place):
            what = "an HDF5 file of something else" + ("" if found else ", or without its seal")
        if found in KINDS:
            what = KINDS[found][0]
        raise PathError(f"cannot write {target}: it is {what}; choose another name")


def _with_grids(solution: Solution, asked: bool | Sequence[str] | None) -> list[str]:
    """Return the links whose grids are stored. Raises :class:`.UnknownNameError` for others."""
    links = solution.links_with_sections
    if asked is None:
        pieces = solution.description.pieces
        return [link for link in links if link not in pieces]
    if isinstance(asked, bool):
        return list(links) if asked else []
    check_known("link with sections", asked, links)
    return [link for link in links if link in asked]


def _require_space(datasets: Iterable[Stored], target: Path) -> None:
    """Raise :class:`StoreError` where the disk has less room than the datasets take."""
    size = 8 * sum(math.prod(dataset.values.shape) for dataset in datasets)
    try:
        free = shutil.disk_usage(target.parent).free
    except OSError:
        return
    if size > free:
        raise StoreError(
            f"cannot write {target}: it takes {size / 1e9:.4g} GB, and the disk has"
            f" {free / 1e9:.3g} GB left"
        )


@public
def load(path: str | os.PathLike[str]) -> Solution:
    """Read a solution from its file.

    Parameters
    ----------
    path
        The file of a run.

    Returns
    -------
    Solution
        The solution, without its scene.

    Raises
    ------
    PathError
        If there is no such file.
    StoreError
        If the file is damaged, incomplete, or of another schema.
    """
    with opened_file(path, RUN) as file:
        return _read(file)


def figure_specs(path: str | os.PathLike[str]) -> tuple[object, ...]:
    """Specifications of the case's figures, as they were given to :func:`save`.

    Raises what :func:`load` does.
    """
    with opened_file(path, RUN) as file:
        return figures_of(file.attrs)


@public
def check(path: str | os.PathLike[str]) -> list[str]:
    """Check a file of a run, and return its faults.

    Every dataset is read, so its checksum is verified; every value must be finite, every axis have
    its scale, every unit and sign be the schema's; and section grids, where stored, must agree with
    the laws to 1e-12 of their peak.

    Parameters
    ----------
    path
        The file.

    Returns
    -------
    list of str
        The faults, one line each; empty if the file is complete and consistent.

    Raises
    ------
    PathError, StoreError
        As :func:`load`.
    """
    with opened_file(path, RUN) as file:
        solution = _read(file)
        links = solution.links_with_sections
        if "grids" in file.attrs:
            kept = parsed(file.attrs["grids"], tuple[str, ...], "grids")
            links = tuple(link for link in links if link in kept)
        datasets = [*datasets_of(solution, links)]
        listed = map(Output.of, parsed(file.attrs["outputs"], tuple[str, ...]))
        places = {dataset.place for dataset in datasets}
        found = [f"{place}: missing" for place in map(place_of, listed) if place not in places]
        found += check_attributes(file.attrs, solution.description)
        if not found:
            found += unlike_conventions(file, solution.table)
            found += _check_drive_axis(solution)
            found += [fault for dataset in datasets for fault in dataset.faults(file, solution)]
            found += _check_certificate(file, solution)
    return found


def _check_certificate(file: h5py.File, solution: Solution) -> Iterator[str]:
    """The stored residuals and what is said of them, and the same computed anew from what is
    stored.
    """
    worse = f"is worse than the tolerance {solution.tolerance:.3g}"
    for name, value in solution.failed.items():
        yield f"certificate/{name}: {value:.3g} {worse}"
    # Of angles of very many turns not enough digits are reported to compute anything anew.
    if solution.certificate and blur(solution) < COARSE:
        for name, value in replace(solution, certificate=certify(solution)).failed.items():
            yield f"{name}: {value:.3g}, computed anew, {worse}"
    if (
        not TOLERANCE <= solution.tolerance <= COARSE
        or bool(file.attrs["certified"]) != solution.certified
    ):
        yield "certificate: the verdict or its tolerance is not what follows from the residuals"


def _check_drive_axis(solution: Solution) -> Iterator[str]:
    """The coordinate by which instants were asked for: in equal steps, and that of the
    motion, where this is there.
    """
    if solution.over is None:
        return
    values = solution.over.values
    if not are_even(values):
        yield f"{OVER}: not in equal steps"
    joint = solution.over.joint
    motion, rate = (
        solution.outputs.get(Output("motion", joint, member)) for member in ("", "rate")
    )
    allowed = _OVER_TOLERANCE.get(solution.provenance.precision, 0.0) * float(np.abs(values).max())
    if rate is not None:
        # Times are doubles, and a fast drive far from zero moves on between two of them.
        allowed += 4.0 * float(np.max(np.abs(rate)) * np.spacing(np.abs(solution.t).max()))
    if motion is not None and not np.abs(motion - values).max() <= allowed:
        yield f"{OVER}: not the coordinate of joint '{joint}'"


def _read(file: h5py.File) -> Solution:
    check_links(file)
    stated = read_attributes(file.attrs)
    description, errors, reasons = stated["description"], stated["errors"], stated.pop("holding")
    t, xi = (numbers(file[axis]) for axis in AXES)
    if t.ndim != 1 or xi.ndim != 1 or not t.size or not xi.size:
        raise ValueError(f"t and xi have the shapes {t.shape} and {xi.shape}")
    datasets: dict[str, h5py.Dataset] = {}

    def visit(place: str, item: h5py.Group | h5py.Dataset) -> None:
        if isinstance(item, h5py.Dataset):
            datasets[place] = item

    file.visititems(visit)
    outputs: dict[Output, Array] = {}
    for place, dataset in datasets.items():
        if place in (*AXES, OVER) or place.startswith(f"{SENSITIVITY}/"):
            continue
        output = Output.of(place.replace("/", ":"))
        if "error_estimate" in dataset.attrs:
            errors[str(output)] = number(dataset.attrs, "error_estimate")
        if output.quantity.axes == ("t",) and output.group not in ("certificate", "holding"):
            outputs[output] = numbers(dataset, t.shape)
    histories = Solution(
        t=t,
        xi=xi,
        outputs=in_order(outputs, description),
        over=drive_axis(file[OVER], t.shape, description) if OVER in file else None,
        **stated,
    )
    for link in histories.links_with_sections:
        law = histories.section(link).law
        whole = set(law.coefficients) == set(histories.table.law) and all(
            distributed.sound for distributed in law.distributed_loads
        )
        if not whole or len(law.density.breaks) != len(law.density.cells) + 1:
            raise ValueError(f"the law or the density of '{link}' is incomplete")
    residuals = file.get("certificate", {})
    return replace(
        histories,
        certificate={name: numbers(residuals[name], t.shape) for name in residuals},
        sensitivities=slopes_of(datasets, histories),
        holding=_held(file, histories, reasons),
    )


def _held(file: h5py.File, histories: Histories, reasons: Mapping[str, str]) -> dict[str, Holding]:
    """The ranges of the efforts that joints at rest leave open, with the reason of each.

    Raises ``ValueError`` for those of what is no drive.
    """
    found = {}
    for name, reason in reasons.items():
        if Output("effort", name) not in histories.outputs:
            raise ValueError(f"there is a range of efforts of '{name}', which is no drive")
        least, largest = (
            numbers(file[place_of(Output("holding", name, end))], histories.t.shape) for end in ENDS
        )
        found[name] = Holding(least, largest, histories.unit(Output("effort", name)), reason)
    return found


def drive_axis(
    dataset: h5py.Dataset, shape: tuple[int, ...], description: Description
) -> DriveAxis:
    """The coordinate by which instants were asked for.

    Raises ``ValueError`` for that of a joint which is not driven.
    """
    values, joint, unit = (
        numbers(dataset, shape),
        shown(dataset.attrs["joint"]),
        shown(dataset.attrs["units"]),
    )
    kind = description.driven.get(joint)
    if kind is None or unit != (LENGTH if kind == "slide" else ANGLE):
        raise ValueError(
            f"the instants are over '{joint}' in {unit}, which is no drive's coordinate"
        )
    return DriveAxis(joint, unit, values)
