"""Numbers of a file, and the coordinate by which its instants were asked for."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from ..base.arrays import Array
from ..base.tables import ANGLE, LENGTH
from ..declare.description import Description, motions_of
from ..declare.times import DriveAxis
from .untrusted import check_chunks, check_dataset, shown

if TYPE_CHECKING:
    import h5py


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
    kind = motions_of(description).get(joint)
    if kind is None or unit != (LENGTH if kind == "slide" else ANGLE):
        raise ValueError(
            f"the instants are over '{joint}' in {unit}, which is no drive's coordinate"
        )
    return DriveAxis(joint, unit, values)


def numbers(dataset: h5py.Dataset, shape: tuple[int, ...] | None = None) -> Array:
    """The numbers of a dataset, of a shape if one is given.

    Raises ``ValueError`` for what has others.
    """
    check_numbers(dataset, shape)
    return np.asarray(dataset[()], np.float64)


def check_numbers(dataset: h5py.Dataset, shape: Sequence[int] | None) -> None:
    """Raise ``ValueError`` for a dataset that has no numbers, or another shape."""
    check_dataset(dataset, shape)
    check_chunks(dataset)
