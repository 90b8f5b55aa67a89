"""The file of a search: HDF5, sealed like all files of the package."""

from __future__ import annotations

import os
from pathlib import Path

import h5py
import numpy as np

from ..system.publish import replacing
from ..system.seal import seal
from .optimum import Optimum

SCHEMA, VERSION = "lagrange-casadi-optimum", 1


def save_optimum(optimum: Optimum, path: str | os.PathLike[str]) -> None:
    """Write the history and the result of a search, replacing the file at ``path`` whole or not at all.

    Raises :class:`.PathError` where no file can be put there, :class:`.StoreError` where it cannot be written.
    """
    names = list(optimum.values)
    with replacing(Path(path), hdf5=True) as draft:
        with h5py.File(draft, "w", track_order=True) as file:
            file.attrs.update({"schema": SCHEMA, "schema_version": VERSION, "case": optimum.case})
            file.attrs.update({"minimised": str(optimum.minimised), "unit": optimum.unit, "objective": optimum.objective})
            for name in ("feasible", "converged", "stopped", "residual", "curvature", "transmission", "evaluations"):
                file.attrs[name] = getattr(optimum, name)
            parameters = file.create_group("parameters", track_order=True)
            for name, value in optimum.parameters.items():
                parameters[name] = value
                parameters[name].attrs["chosen"] = name in names
                if name in names:
                    parameters[name].attrs["multiplier"] = optimum.bounds[name]
            limits = file.create_group("limits", track_order=True)
            for number, limit in enumerate(optimum.limits):
                group = limits.create_group(f"{number}")
                group.attrs.update({"constraint": str(limit.constraint), "value": limit.value, "limit": limit.constraint.limit})
                group.attrs.update({"active": limit.active, "multiplier": limit.multiplier})
            starts = file.create_group("starts", track_order=True)
            for number, start in enumerate(optimum.starts):
                group = starts.create_group(f"{number}")
                group["start"], group["end"] = (np.array([values[name] for name in names]) for values in (start.values, start.end))
                group.attrs.update({"objective": start.objective, "excess": start.excess, "ending": start.ending})
            history = file.create_dataset("history", data=optimum.history)
            history.attrs["columns"] = ["start", "objective", "excess", "result", *names]
            file.attrs["complete"] = True
        seal(draft, SCHEMA)
