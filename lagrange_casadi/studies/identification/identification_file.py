"""The file of an identification."""

from __future__ import annotations

import math
import os

import h5py
import numpy as np

from ...base.arguments import public
from ...results.store.opening import IDENTIFICATION, sealed_file
from .fit import Comparison
from .identification import Identification


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
    with sealed_file(path, IDENTIFICATION) as file:
        file.attrs.update(
            {
                "case": found.name,
                "measurements": found.measurements,
                "condition": found.condition,
                "rounds": found.rounds,
                "cutoff": found.cutoff or math.inf,
                "unexcited": list(found.unexcited),
                "absent": list(found.absent),
                "impossible": list(found.impossible),
            }
        )
        group = file.create_group("parameters", track_order=True)
        for name, value in found.values.items():
            group[name] = value
            group[name].attrs.update(
                {
                    "error": found.errors[name],
                    "units": found.units[name],
                    "nonlinear_with": list(found.nonlinear.get(name, ())),
                    "initial": found.initial[name],
                    "prior": found.prior.get(name, math.inf),
                }
            )
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


def _write(group: h5py.Group, compared: Comparison) -> None:
    group["t"] = compared.t
    group["t"].attrs["units"] = "s"
    relative = compared.relative
    for name, measured in compared.measured.items():
        item = group.create_group(name.replace("/", "|"))
        item.attrs.update({"units": compared.units[name], "relative": relative[name]})
        item["measured"], item["model"] = measured, compared.model[name]
