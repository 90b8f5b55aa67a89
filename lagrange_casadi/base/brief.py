"""Dataclasses that hold arrays, in a line."""

from __future__ import annotations

from dataclasses import fields

import numpy as np

from ..errors import shown

_FEW = 4
"""Numbers of an array that are written out."""


class Brief:
    """A dataclass that Python writes in a line: of an array its shape, and from where to where its
    numbers are.
    """

    def __repr__(self) -> str:
        entries = fields(self)  # type: ignore[arg-type]
        each = ", ".join(f"{entry.name}={_brief(getattr(self, entry.name))}" for entry in entries)
        return f"{type(self).__name__}({each})"


def _brief(value: object) -> str:
    if not isinstance(value, np.ndarray) or value.size <= _FEW:
        return shown(value)
    shape = " x ".join(map(str, value.shape))
    if value.dtype.kind not in "iuf" or not np.isfinite(value).any():
        return f"<{shape} of {value.dtype}>"
    return f"<{shape} from {np.nanmin(value):.5g} to {np.nanmax(value):.5g}>"
