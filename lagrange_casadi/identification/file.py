"""The file of an identification."""

from __future__ import annotations

import math
import os
from pathlib import Path

import h5py
import numpy as np

from ..arguments import public
from ..base.publish import PatientFile, replacing
from ..base.seal import seal
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
            file.attrs["impossible"] = list(found.impossible)
            group = file.create_group("parameters", track_order=True)
            for name, value in found.values.items():
                group[name] = value
                curved = list(found.nonlinear.get(name, ()))
                group[name].attrs.update({"error": found.errors[name], "units": found.units[name]})
                group[name].attrs["nonlinear_with"] = curved
                group[name].attrs["initial"] = found.initial[name]
                group[name].attrs["prior"] = found.prior.get(name, math.inf)
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
