"""The file and the figure of an identification."""

from __future__ import annotations

import math
import os
from pathlib import Path

import h5py
import numpy as np

from ..arguments import public
from ..base.publish import PatientFile, replacing, writing
from ..base.seal import seal
from ..shapes.pictures import check_picture, one_at_a_time, save
from ..store.opening import IDENTIFICATION, IDENTIFICATION_VERSION
from .identification import Comparison, Identification


@public
def save_identification(
    found: Identification, path: str | os.PathLike[str], validation: Comparison | None = None
) -> None:
    """Write an identification to an HDF5 file, replacing the file whole or not at all.

    Parameters
    ----------
    found
        The result of :func:`.identify`.
    path
        The file.
    validation
        Comparison with another record.

    Raises
    ------
    PathError
        If no file can be put there.
    """
    with replacing(Path(path), hdf5=True) as draft:
        with PatientFile(draft, "x+") as bytes_, h5py.File(bytes_, "w", track_order=True) as file:
            file.attrs.update(
                {
                    "schema": IDENTIFICATION,
                    "schema_version": IDENTIFICATION_VERSION,
                    "case": found.name,
                    "measurements": found.measurements,
                    "condition": found.condition,
                }
            )
            file.attrs.update({"rounds": found.rounds, "cutoff": found.cutoff or math.inf})
            file.attrs.update({"unexcited": list(found.unexcited), "absent": list(found.absent)})
            group = file.create_group("parameters", track_order=True)
            for name, value in found.values.items():
                group[name] = value
                curved = list(found.nonlinear.get(name, ()))
                group[name].attrs.update({"error": found.errors[name], "units": found.units[name]})
                group[name].attrs["nonlinear_with"] = curved
            group = file.create_group("base")
            group.attrs["words"] = [one.words for one in found.base]
            group.attrs["units"] = [one.unit for one in found.base]
            group["values"] = np.array([one.value for one in found.base])
            group["errors"] = np.array([one.error for one in found.base])
            group["covariance"] = found.covariance
            for drive, cutoff in found.cutoffs.items():
                file.require_group("smoothing").attrs[drive] = cutoff
            _write(file.create_group("record", track_order=True), found.comparison)
            for name, noise in found.noise.items():
                item = file["record"][name.replace("/", "|")]
                item.attrs.update({"noise": noise, "outliers": found.outliers.get(name, 0.0)})
            if validation is not None:
                _write(file.create_group("validation", track_order=True), validation)
            file.attrs["complete"] = True
        seal(draft, IDENTIFICATION)


def _write(group: h5py.Group, compared: Comparison) -> None:
    group["t"] = compared.t
    group["t"].attrs["units"] = "s"
    relative = compared.relative
    for name, measured in compared.measured.items():
        item = group.create_group(name.replace("/", "|"))
        item.attrs.update({"units": compared.units[name], "relative": relative[name]})
        item["measured"], item["model"] = measured, compared.model[name]


@public
@one_at_a_time()
def plot_identification(compared: Comparison, path: str | os.PathLike[str]) -> None:
    """Draw measurements and model over time, and what is left, into a file.

    Parameters
    ----------
    compared
        The ``comparison`` of an :class:`.Identification`, or that of another record.
    path
        A name that ends in .png, .pdf or .svg.

    Raises
    ------
    DeclarationError
        For another ending.
    PathError
        If the file cannot be written.
    """
    target = Path(path)
    check_picture(target)
    from matplotlib.figure import Figure

    names = list(compared.measured)
    figure = Figure(figsize=(9.0, 2.2 * len(names) + 0.6), layout="constrained")
    axes = figure.subplots(len(names), 2, squeeze=False, sharex=True)
    for name, (left, right) in zip(names, axes, strict=True):
        measured, model = compared.measured[name], compared.model[name]
        left.plot(compared.t, measured, ".", color="0.6", ms=2, label="measured")
        left.plot(compared.t, model, color="#1f4e79", lw=1.0, label="model")
        right.plot(compared.t, measured - model, ".", color="#c0392b", ms=2, label="difference")
        left.set_ylabel(f"{name} [{compared.units[name]}]", fontsize=8)
        right.set_title(f"{100 * compared.relative[name]:.3g} % of measured", fontsize=8)
        for one in (left, right):
            one.grid(True, color="0.92")
    for one in axes[-1]:
        one.set_xlabel("t [s]")
    handles = [line for one in axes[0] for line in one.get_legend_handles_labels()[0]]
    figure.legend(handles=handles, loc="outside lower center", ncols=3, frameon=False, fontsize=9)
    with writing(target) as (file,):
        save(figure, file, target.suffix)
